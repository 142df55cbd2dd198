//! Who may talk to the server: pages that it served itself, in a browser on this machine.
//!
//! Only this machine can connect, but every page in its browser can try to. A page of another site is told by its `Origin`
//! or by what browsers add as `Sec-Fetch-Site`; a name that such a site has pointed at this machine by its `Host`.

use axum::http::{HeaderMap, Method, header};

/// The names that this machine is called by.
const NAMES: [&str; 2] = ["127.0.0.1", "localhost"];

/// Why a request is refused; `None` if it is not. `port` is the server's own.
pub(super) fn refusal(method: &Method, headers: &HeaderMap, port: u16) -> Option<&'static str> {
    let is_own = |text: &str| {
        let own = |name: &str| text == format!("{name}:{port}") || (port == 80 && text == name);
        NAMES.iter().any(|name| own(name))
    };
    let value = |name| headers.get(name).map(|value| value.to_str().unwrap_or("?"));
    if headers.get_all(header::HOST).iter().count() != 1 || !value(header::HOST).is_some_and(is_own)
    {
        return Some("this server answers to its own name only");
    }
    let origin = value(header::ORIGIN);
    let is_foreign = |origin: &str| !origin.strip_prefix("http://").is_some_and(is_own);
    if origin.is_some_and(is_foreign) {
        return Some("requests of other sites are not answered");
    }
    let site = headers.get("sec-fetch-site");
    let site = site.map(|site| site.to_str().unwrap_or("?"));
    // `none`: typed by the user. A link on another site may lead here, but not fetch anything.
    let is_visit = headers
        .get("sec-fetch-mode")
        .is_some_and(|mode| mode == "navigate");
    if site.is_some_and(|site| site != "same-origin" && site != "none" && !is_visit) {
        return Some("requests of other sites are not answered");
    }
    // Browsers name the origin of all that may change something.
    if !matches!(*method, Method::GET | Method::HEAD) && origin.is_none() {
        return Some("a request that changes something has to say where it comes from");
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use axum::http::HeaderName;

    fn is_refused(method: Method, headers: &[(&'static str, &'static str)]) -> bool {
        let mut map = HeaderMap::new();
        for (name, value) in headers {
            map.append(HeaderName::from_static(name), value.parse().unwrap());
        }
        refusal(&method, &map, 7300).is_some()
    }

    #[test]
    fn only_its_own_pages_are_answered() {
        let host = ("host", "localhost:7300");
        let origin = ("origin", "http://localhost:7300");
        let visit = ("sec-fetch-mode", "navigate");
        for (headers, refused) in [
            (vec![host], false),
            (vec![("host", "127.0.0.1:7300"), origin], false),
            (vec![], true),
            (vec![host, host], true),
            (vec![("host", "localhost")], true),
            (vec![("host", "evil.example:7300")], true),
            (vec![("host", "localhost:7300.evil.example")], true),
            (vec![host, ("origin", "http://evil.example")], true),
            (vec![host, ("origin", "null")], true),
            (vec![host, ("origin", "http://localhost:8000")], true),
            (vec![host, ("sec-fetch-site", "cross-site")], true),
            (vec![host, ("sec-fetch-site", "same-site")], true),
            (vec![host, ("sec-fetch-site", "cross-site"), visit], false),
            (vec![host, ("sec-fetch-site", "same-origin")], false),
        ] {
            assert_eq!(is_refused(Method::GET, &headers), refused, "{headers:?}");
        }
        assert!(is_refused(Method::POST, &[host]));
        assert!(!is_refused(Method::POST, &[host, origin]));
    }
}
