#!/bin/bash
# tests/vm/calibrate.sh PROGRAM V4L2LOOPBACK: what is run inside the virtual machine, as root, to
# calibrate with the kernel's own cameras. PROGRAM is vm_calibrate_test, V4L2LOOPBACK the module
# built for the machine's kernel.
set -eu
modprobe vivid n_devs=1 input_types=0x00 num_inputs=1 no_error_inj=0 vid_cap_nr=0
insmod "$2" video_nr=7 card_label=Loopback max_buffers=4
# What llvmpipe compiles for AVX2 crashes on QEMU's emulation of it.
export LP_NATIVE_VECTOR_WIDTH=128 GALLIUM_OVERRIDE_CPU_CAPS=sse4.1
export DISPLAY=:99
Xvfb $DISPLAY -screen 0 160x90x24 -nolisten tcp -noreset >x.log 2>&1 &
status=0
"$1" || status=$?
kill $!
exit $status
