//! Lines between a controller and its host.

/// USB vendor and product number. Without `COPHASE_USB_ID` in the environment of the build, it is one for tests, of pid.codes, which no
/// product may have (docs/link.md, "Lines").
pub const USB_ID: (u16, u16) = match option_env!("COPHASE_USB_ID") {
    Some(id) => usb_id(id),
    None => (0x1209, 0x0001),
};

/// USB product name.
pub const USB_PRODUCT: &str = "Cophase controller";

/// Beginning of the USB serial number. Other devices may have the same [`USB_ID`], and not all operating systems give a host the product
/// name.
pub const USB_SERIAL_PREFIX: &str = "COPHASE-";

/// Baud rate of the UART, with 8 data bits, no parity, 1 stop bit.
pub const UART_BAUD: u32 = 115_200;

/// Reads `VID:PID`, each of four hexadecimal digits.
const fn usb_id(text: &str) -> (u16, u16) {
    let text = text.as_bytes();
    assert!(
        text.len() == 9 && text[4] == b':',
        "COPHASE_USB_ID: give VID:PID in hexadecimal digits, such as 1209:0001"
    );
    (hexadecimal(text, 0), hexadecimal(text, 5))
}

const fn hexadecimal(text: &[u8], from: usize) -> u16 {
    let mut number = 0;
    let mut at = from;
    while at < from + 4 {
        let digit = match text[at] {
            digit @ b'0'..=b'9' => digit - b'0',
            digit @ b'a'..=b'f' => digit - b'a' + 10,
            digit @ b'A'..=b'F' => digit - b'A' + 10,
            _ => panic!("COPHASE_USB_ID: give VID:PID in hexadecimal digits, such as 1209:0001"),
        };
        number = number << 4 | digit as u16;
        at += 1;
    }
    number
}

#[cfg(test)]
mod tests {
    use super::usb_id;

    #[test]
    fn a_usb_id_is_read_in_small_and_large_digits() {
        assert_eq!(usb_id("2e8a:00C0"), (0x2e8a, 0x00c0));
    }

    #[test]
    #[should_panic(expected = "VID:PID")]
    fn a_usb_id_without_a_product_is_refused() {
        usb_id("2e8a");
    }
}
