#!/bin/bash
# tests/vm/camera.sh PROGRAM V4L2LOOPBACK FILM: what is run inside the virtual machine, as root, to
# try the camera driver. PROGRAM is vm_camera_test, V4L2LOOPBACK the module built for the machine's
# kernel, FILM a video of JPEG pictures, 640 x 360.
set -eu
export FANTASCOPE_FILM=$3
# The webcam among vivid's inputs has sizes and rates as a USB camera does.
vivid=(vivid n_devs=1 input_types=0x00 num_inputs=1 no_error_inj=0)
modprobe "${vivid[@]}" vid_cap_nr=0
insmod "$2" video_nr=7 card_label=Loopback max_buffers=4
"$1" --gtest_filter='-*contract*'
# The other variant of the interface, which cameras on a board speak.
until modprobe -r vivid 2>/dev/null; do :; done # whoever looked at its nodes when they came is gone soon
modprobe "${vivid[@]}" multiplanar=2
"$1" --gtest_filter='*colours*:*dmabufs*:*flag*:*unplugged*'
# Two of them, for the contract.
until modprobe -r vivid 2>/dev/null; do :; done
modprobe "${vivid[@]/n_devs=1/n_devs=2}" vid_cap_nr=10,11
"$1" --gtest_filter='*contract*'
