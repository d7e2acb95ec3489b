#!/bin/bash
# tests/vm/usb_hid.sh PROGRAM [ARGUMENT...]: what is run inside the virtual machine, as root, to try
# the hand controller's driver. PROGRAM is vm_usb_hid_test. The kernel's own gadgets make two USB
# devices of this machine, and dummy_hcd plugs them into the same machine.
set -eu
modprobe dummy_hcd num=2
modprobe -a libcomposite usb_f_hid usbhid
mountpoint -q /sys/kernel/config || mount -t configfs configfs /sys/kernel/config
gadget() { # NAME SERIAL: its end here is the next /dev/hidg*
  mkdir -p "/sys/kernel/config/usb_gadget/$1" && cd "/sys/kernel/config/usb_gadget/$1"
  echo 0x16c0 > idVendor
  echo 0x27d9 > idProduct
  echo 0x0200 > bcdUSB
  mkdir -p strings/0x409 configs/c.1/strings/0x409 functions/hid.usb0
  echo "$2" > strings/0x409/serialnumber
  echo Lumen > strings/0x409/manufacturer
  echo "Hand Cue Controller" > strings/0x409/product
  echo hid > configs/c.1/strings/0x409/configuration
  echo 0 > functions/hid.usb0/protocol
  echo 0 > functions/hid.usb0/subclass
  echo 1 > functions/hid.usb0/report_length
  # Eight buttons in a byte, and three lamps in another. In one piece: every write is a descriptor
  # of its own.
  printf '\x05\x01\x09\x05\xa1\x01\x05\x09\x19\x01\x29\x08\x15\x00\x25\x01\x75\x01\x95\x08\x81\x02'\
'\x05\x08\x19\x01\x29\x03\x95\x03\x91\x02\x95\x05\x91\x03\xc0' > functions/hid.usb0/report_desc
  ln -s functions/hid.usb0 configs/c.1/
}
gadget cue CUE-7
gadget neighbour CUE-8
cd /
exec "$@"
