//! Access control: the token, and the server's own host and origin.
//!
//! The token is in the path of the page, so that every file and the socket need it, and no cookie carries it to another
//! page. `Host` must be the server's own: a foreign name that resolves to this computer is refused. `Origin`, which a page
//! of another site cannot change, must be the server's own if it is present. A socket requires it.

use std::net::SocketAddr;

use subtle::ConstantTimeEq;

/// Bytes of randomness in a token.
const TOKEN_BYTES: usize = 16;

/// Part of a request's head on which access depends.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Credentials<'a> {
    pub(super) path: &'a str,
    pub(super) host: Option<&'a str>,
    pub(super) origin: Option<&'a str>,
}

/// Reason why a request is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub(super) enum Denied {
    #[error("the request is for another host; open the address that `cophase scope` printed")]
    Host,
    #[error("the token is missing or wrong; open the address that `cophase scope` printed")]
    Token,
    #[error("the slash at the end of the page's address is missing; add it")]
    Slash,
    #[error(
        "the request comes from a page of another origin; open the address that `cophase scope` printed"
    )]
    Origin,
}

#[derive(Debug)]
pub(super) struct Access {
    token: String,
    hosts: Vec<String>,
}

impl Access {
    /// Draws a random token for a server at an address.
    pub(super) fn new(address: SocketAddr) -> Result<Self, getrandom::Error> {
        let mut bytes = [0; TOKEN_BYTES];
        getrandom::fill(&mut bytes)?;
        let mut hosts = vec![address.to_string()];
        if address.ip().is_loopback() {
            hosts.push(format!("localhost:{}", address.port()));
        }
        // Browsers leave out the port of HTTP.
        if address.port() == 80 {
            let plain = |host: &String| host.trim_end_matches(":80").to_owned();
            hosts.extend(hosts.iter().map(plain).collect::<Vec<_>>());
        }
        Ok(Self {
            token: bytes.iter().map(|byte| format!("{byte:02x}")).collect(),
            hosts,
        })
    }

    /// Returns the address of the page.
    pub(super) fn url(&self) -> String {
        format!("http://{}/{}/", self.hosts[0], self.token)
    }

    /// Returns the origins to which sockets of the page may connect.
    pub(super) fn sockets(&self) -> impl Iterator<Item = String> {
        self.hosts.iter().map(|host| format!("ws://{host}"))
    }

    /// Returns the path of the file that a request names, if access is permitted.
    pub(super) fn check<'a>(&self, credentials: &Credentials<'a>) -> Result<&'a str, Denied> {
        let own = |host: &str| self.hosts.iter().any(|own| own.eq_ignore_ascii_case(host));
        let host = credentials.host.filter(|host| own(host));
        let host = host.ok_or(Denied::Host)?;
        let path = credentials.path.strip_prefix('/').ok_or(Denied::Token)?;
        let (token, file) = path
            .split_once('/')
            .map_or((path, None), |(token, file)| (token, Some(file)));
        if !bool::from(token.as_bytes().ct_eq(self.token.as_bytes())) {
            return Err(Denied::Token);
        }
        let file = file.ok_or(Denied::Slash)?;
        let same = |origin: &str| origin.strip_prefix("http://") == Some(host);
        if credentials.origin.is_some_and(|origin| !same(origin)) {
            return Err(Denied::Origin);
        }
        Ok(file)
    }
}
