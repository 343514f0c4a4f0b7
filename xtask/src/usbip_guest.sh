#!/bin/busybox sh
# The first program of the guest of `cargo xtask usbip`: attaches the device, asks it, updates it, and says what it saw.
/bin/busybox mkdir -p /proc /sys /dev
/bin/busybox --install -s /bin
export PATH=/bin:/usr/sbin
mount -t proc none /proc
mount -t sysfs none /sys
mount -t devtmpfs none /dev
for module in e1000 usb-common usbcore usbip-core vhci-hcd cdc-acm; do
    insmod /modules/$module.ko
done
ifconfig lo 127.0.0.1 up
ifconfig eth0 10.0.2.15 netmask 255.255.255.0 up
echo "kernel: $(uname -r)"
# A device that restarts leaves its bus: it is attached again, as a hand puts a plug back.
(while true; do
    usbip attach -r 10.0.2.2 -b 1-1 >/dev/null 2>&1
    sleep 1
done) &
for second in $(seq 60); do
    [ -e /dev/ttyACM0 ] && break
    sleep 1
done
dmesg | grep -E 'usb 1-1|cdc_acm'
usb=$(readlink -f /sys/class/tty/ttyACM0/device)/..
echo "names: $(cat $usb/manufacturer), $(cat $usb/product), $(cat $usb/serial)"
info() {
    stty -F /dev/ttyACM0 raw -echo
    exec 3<>/dev/ttyACM0
    sleep "$1"
    printf 'AT+INFO\r\n' >&3
    timeout 6 cat <&3
    exec 3>&-
}
# Behind the bootloader's window.
info 8
squitter update /squitter.sqt
echo "update: $?"
info 1
dmesg | grep -E 'usb 1-1|cdc_acm' | tail -n 8
poweroff -f
