//! Addresses of a network as a user writes them: the parts, and what is wrong with them.

use std::net::Ipv6Addr;

/// Parts of `PROTOCOL://USER@HOST:PORT/PATH`. Only the host is always there, and it may be empty.
pub(crate) struct Parts<'a> {
    pub(crate) protocol: Option<&'a str>,
    /// The host, without the brackets of an IPv6 address.
    pub(crate) host: &'a str,
    port: Option<&'a str>,
    /// False if there is more than host and port.
    is_plain: bool,
}

impl<'a> Parts<'a> {
    pub(crate) fn parse(text: &'a str) -> Self {
        let (protocol, rest) = text
            .split_once("://")
            .map_or((None, text), |(protocol, rest)| (Some(protocol), rest));
        let address = rest.split('/').next().unwrap_or_default();
        let address = address.rsplit('@').next().unwrap_or_default();
        let (host, port) = host_and_port(address);
        Self {
            protocol,
            host,
            port,
            is_plain: address.len() == text.len(),
        }
    }

    /// Returns the text of the port, or none if it is missing.
    pub(crate) fn port(&self) -> Option<&'a str> {
        self.port.filter(|port| !port.is_empty())
    }

    /// Returns the number of the port, or none if it is missing or is no number of a port.
    pub(crate) fn port_number(&self) -> Option<u16> {
        self.port()?.parse().ok().filter(|port| *port != 0)
    }

    /// Returns `HOST:PORT`, with these words for a part that is missing or wrong.
    pub(crate) fn full(&self) -> String {
        let host = match self.host {
            "" => "HOST".to_owned(),
            host if host.contains(':') => format!("[{host}]"),
            host => host.to_owned(),
        };
        let port = self.port_number();
        let port = port.map_or_else(|| "PORT".to_owned(), |port| port.to_string());
        format!("{host}:{port}")
    }

    /// Returns what is wrong with `HOST:PORT`, or none.
    pub(crate) fn problem(&self) -> Option<String> {
        if self.host.is_empty() {
            return Some("the host is missing".to_owned());
        }
        match (self.port(), self.port_number()) {
            (None, _) => Some("the port is missing".to_owned()),
            (Some(port), None) => Some(format!("port {port} is no number from 1 to 65535")),
            _ if !self.is_plain => Some("it takes a host and a port only".to_owned()),
            _ => None,
        }
    }
}

fn host_and_port(address: &str) -> (&str, Option<&str>) {
    if let Some((host, rest)) = address
        .strip_prefix('[')
        .and_then(|rest| rest.split_once(']'))
    {
        return (host, rest.strip_prefix(':'));
    }
    let is_ipv6 = |text: &str| text.parse::<Ipv6Addr>().is_ok();
    match address.rsplit_once(':') {
        // All of `::1` is a host. In `fe80::1:5000`, which has both readings, the last number is a port.
        Some((host, _)) if is_ipv6(address) && !is_ipv6(host) => (address, None),
        Some((host, port)) => (host, Some(port)),
        None => (address, None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_is_completed_and_its_problem_named() {
        for (text, full, problem) in [
            ("127.0.0.1:5000", "127.0.0.1:5000", None),
            ("board.local:5000", "board.local:5000", None),
            ("[::1]:5000", "[::1]:5000", None),
            ("fe80::1:5000", "[fe80::1]:5000", None),
            ("127.0.0.1", "127.0.0.1:PORT", Some("the port is missing")),
            ("board", "board:PORT", Some("the port is missing")),
            ("board:", "board:PORT", Some("the port is missing")),
            ("::1", "[::1]:PORT", Some("the port is missing")),
            ("[::1]", "[::1]:PORT", Some("the port is missing")),
            (":5000", "HOST:5000", Some("the host is missing")),
            ("", "HOST:PORT", Some("the host is missing")),
            (
                "board:five",
                "board:PORT",
                Some("port five is no number from 1 to 65535"),
            ),
            (
                "board:70000",
                "board:PORT",
                Some("port 70000 is no number from 1 to 65535"),
            ),
            (
                "http://me@board:80/page",
                "board:80",
                Some("it takes a host and a port only"),
            ),
        ] {
            let parts = Parts::parse(text);
            assert_eq!(parts.full(), full, "{text}");
            assert_eq!(parts.problem().as_deref(), problem, "{text}");
        }
    }
}
