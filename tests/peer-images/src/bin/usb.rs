//! USB: enumerates as a CDC-ACM device and sends back what it gets in upper case. Both hosts open it and send a line (`scenario.rs`).
#![no_std]
#![no_main]

use peer_images as _;
use peer_images::trace::{DONE, PANICKED, finish, record};
use rp2040_hal::clocks::init_clocks_and_plls;
use rp2040_hal::pac::Peripherals;
use rp2040_hal::usb::UsbBus;
use rp2040_hal::watchdog::Watchdog;
use usb_device::class_prelude::UsbBusAllocator;
use usb_device::prelude::{StringDescriptors, UsbDeviceBuilder, UsbDeviceState, UsbVidPid};
use usbd_serial::SerialPort;

/// Hz.
const CRYSTAL: u32 = 12_000_000;

#[unsafe(no_mangle)]
extern "C" fn main() -> ! {
    let Some(p) = Peripherals::take() else {
        finish(PANICKED)
    };
    let mut resets = p.RESETS;
    let mut watchdog = Watchdog::new(p.WATCHDOG);
    let clocks = init_clocks_and_plls(
        CRYSTAL,
        p.XOSC,
        p.CLOCKS,
        p.PLL_SYS,
        p.PLL_USB,
        &mut resets,
        &mut watchdog,
    );
    let Ok(clocks) = clocks else { finish(PANICKED) };
    let bus = UsbBusAllocator::new(UsbBus::new(
        p.USBCTRL_REGS,
        p.USBCTRL_DPRAM,
        clocks.usb_clock,
        true,
        &mut resets,
    ));
    let mut serial = SerialPort::new(&bus);
    let strings = StringDescriptors::default().product("Peer");
    // The peer's host wants a descriptor's head in one packet.
    let builder = UsbDeviceBuilder::new(&bus, UsbVidPid(0x1209, 0x0001))
        .strings(&[strings])
        .and_then(|builder| builder.max_packet_size_0(64));
    let Ok(builder) = builder else {
        finish(PANICKED)
    };
    let mut device = builder.device_class(2).build();
    let mut state = UsbDeviceState::Default;
    let mut open = false;
    let mut line = [0; 64];
    loop {
        device.poll(&mut [&mut serial]);
        // Not the idle bus before the first reset, which only one of the hosts has.
        let reached = matches!(
            device.state(),
            UsbDeviceState::Addressed | UsbDeviceState::Configured
        );
        if reached && device.state() != state {
            state = device.state();
            record(0x01, state as u32);
        }
        if serial.dtr() != open {
            open = serial.dtr();
            record(0x02, u32::from(open));
        }
        let Ok(count) = serial.read(&mut line) else {
            continue;
        };
        for byte in &mut line[..count] {
            byte.make_ascii_uppercase();
            record(0x03, u32::from(*byte));
        }
        let mut rest = &line[..count];
        while !rest.is_empty() {
            device.poll(&mut [&mut serial]);
            if let Ok(written) = serial.write(rest) {
                rest = &rest[written..];
            }
        }
        if line[..count].contains(&b'\n') {
            record(0x04, 0);
            // The host fetches the answer while the device is polled.
            for _ in 0..20_000 {
                device.poll(&mut [&mut serial]);
            }
            finish(DONE)
        }
    }
}
