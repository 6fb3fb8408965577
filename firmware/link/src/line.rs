//! Lines between a controller and its host.

/// USB vendor and product number: one for tests, of pid.codes.
pub const USB_ID: (u16, u16) = (0x1209, 0x0001);

/// USB product name, which distinguishes a controller from others with that number.
pub const USB_PRODUCT: &str = "Cophase controller";

/// Baud rate of the UART, with 8 data bits, no parity, 1 stop bit.
pub const UART_BAUD: u32 = 115_200;
