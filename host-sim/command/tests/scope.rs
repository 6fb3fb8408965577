//! `cophase scope` over real sockets: which clients may connect, and which may command.

use crate::support::served::{SCENE, Served};
use serde_json::json;
use tungstenite::Message;

const UPGRADE: [&str; 4] = [
    "Upgrade: websocket",
    "Connection: Upgrade",
    "Sec-WebSocket-Version: 13",
    "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==",
];

#[test]
fn without_the_token_nothing_is_served() {
    let served = Served::new();
    let host = format!("Host: {}", served.host());
    let token = &served.token;
    let mut other = token.clone().into_bytes();
    other[0] ^= 1;
    let other = String::from_utf8(other).unwrap();
    for path in ["/", "/index.html", "/socket", "//", "/x/", "//socket"] {
        assert_eq!(served.get(path, &[&host]), 403, "{path}");
    }
    for file in [
        "",
        "app.js",
        "style.css",
        "vendor/uPlot.iife.min.js",
        "no-such-file",
        "socket",
    ] {
        for wrong in [&other, &token[1..], &format!("{token}0")] {
            let path = format!("/{wrong}/{file}");
            assert_eq!(served.get(&path, &[&host]), 403, "{path}");
        }
    }
    let origin = format!("Origin: http://{}", served.host());
    let mut upgrade = vec![host.as_str(), &origin];
    upgrade.extend(UPGRADE);
    assert_eq!(served.get(&format!("/{other}/socket"), &upgrade), 403);
    assert_eq!(served.get(&format!("/{token}/socket"), &upgrade), 101);
    assert_eq!(served.get(&format!("/{token}/"), &[&host]), 200);
    assert_eq!(served.get(&format!("/{token}/app.js"), &[&host]), 200);
    assert_eq!(
        served.get(&format!("/{token}"), &[&host]),
        403,
        "the slash is missing"
    );
    assert_eq!(
        served.get(&format!("/{token}/../Cargo.toml"), &[&host]),
        404
    );
}

#[test]
fn another_host_or_origin_is_refused() {
    let served = Served::new();
    let (own, path) = (served.host(), format!("/{}/", served.token));
    let host = format!("Host: {own}");
    for other in [
        "evil.example",
        "127.0.0.1",
        "127.0.0.1:1",
        "evil.example:80",
    ] {
        assert_eq!(
            served.get(&path, &[&format!("Host: {other}")]),
            403,
            "{other}"
        );
    }
    assert_eq!(served.get(&path, &[]), 403, "no host");
    assert_eq!(served.get(&path, &[&host, &host]), 403, "two hosts");
    let socket = format!("{path}socket");
    let with = |origin: &[&str]| {
        let mut lines = vec![host.as_str()];
        lines.extend(UPGRADE);
        lines.extend(origin);
        served.get(&socket, &lines)
    };
    let mine = format!("Origin: http://{own}");
    assert_eq!(with(&[&mine]), 101);
    assert_eq!(with(&[]), 403, "no origin");
    for origin in [
        "http://evil.example".to_owned(),
        format!("https://{own}"),
        format!("http://localhost:{}", served.port),
        format!("http://{own}.evil.example"),
        "null".to_owned(),
    ] {
        assert_eq!(with(&[&format!("Origin: {origin}")]), 403, "{origin}");
        // A page of another origin cannot read a file either.
        assert_eq!(
            served.get(&path, &[&host, &format!("Origin: {origin}")]),
            403,
            "{origin}"
        );
    }
    assert_eq!(
        with(&[&mine, "Origin: http://evil.example"]),
        403,
        "two origins"
    );
}

/// Every file has the policy that prevents the page from loading, or connecting to, anything else.
#[test]
fn the_page_may_load_own_files_only() {
    let served = Served::new();
    let host = format!("Host: {}", served.host());
    let line = format!("GET /{}/ HTTP/1.1", served.token);
    let answer = served.answer(&[&line, &host]);
    let policy = answer
        .lines()
        .find_map(|line| line.strip_prefix("Content-Security-Policy: "))
        .expect("there is a policy");
    assert!(
        policy.starts_with("default-src 'none'; script-src 'self'"),
        "{policy}"
    );
    assert!(
        !policy.contains("unsafe-inline") && !policy.contains('*'),
        "{policy}"
    );
    assert!(answer.contains("Referrer-Policy: no-referrer"), "{answer}");
}

#[test]
fn only_one_browser_commands_but_any_may_stop() {
    let served = Served::new();
    let mut first = served.browser();
    let hello = first.wait(|report| report["type"] == "hello");
    let name = hello["name"].as_str().unwrap();
    let mut second = served.browser();
    let refused = |error: Result<(), String>, reason: &str| {
        let error = error.expect_err(reason);
        assert!(error.contains(reason), "{error}");
    };
    refused(first.command("arm"), "take control first");
    first.command("take-control").unwrap();
    for command in [
        "take-control",
        "arm",
        "start",
        "home",
        "jog",
        "hold",
        "reset",
        "release-control",
    ] {
        refused(second.command(command), name);
    }
    refused(
        second.request(json!({ "request": "override", "permille": 500 })),
        "has control",
    );
    refused(
        second.request(json!({ "request": "load", "text": SCENE })),
        "has control",
    );
    let slip = json!({ "kind": "slip", "axis": 0, "rate_deg_per_s": 90 });
    refused(
        second.request(json!({ "request": "inject", "fault": slip })),
        "has control",
    );

    // A start takes two steps: arm, then start.
    refused(first.command("start"), "not armed");
    first.command("arm").unwrap();
    first.command("start").unwrap();
    first.wait_for_state(&["run"]);

    second
        .request(json!({ "request": "stop", "now": true }))
        .unwrap();
    second.wait_for_state(&["stop", "parked"]);
    let status = second.wait_for_state(&["parked"]);
    assert_eq!(status["control"], "other");

    // Control and arming end when the page closes.
    first.command("arm").unwrap();
    drop(first);
    let status = second.wait(|report| report["type"] == "status" && report["control"] == "free");
    assert_eq!(status["armed"], false);
    second.command("take-control").unwrap();
    refused(second.command("start"), "not armed");
    second.command("arm").unwrap();
    second.command("start").unwrap();
    second.wait_for_state(&["run"]);
}

#[test]
fn bad_requests_are_refused_with_the_reason() {
    let served = Served::new();
    let mut browser = served.browser();
    let hello = browser.wait(|report| report["type"] == "hello");
    assert_eq!(hello["text"], SCENE);
    assert_eq!(
        (&hello["simulated"], &hello["axes"]),
        (&json!(true), &json!(3))
    );
    browser.command("take-control").unwrap();
    let other = SCENE.replace("load_kg = 5", "load_kg = 6");
    let wrong = SCENE.replace("amax_g = 2", "amax_g = -2");
    for (request, reason) in [
        (
            json!({ "request": "load", "text": other }),
            "machine differs",
        ),
        (json!({ "request": "load", "text": wrong }), "amax_g"),
        (json!({ "request": "load", "text": "x" }), "the program"),
        (
            json!({ "request": "override", "permille": 1201 }),
            "0 to 1200",
        ),
        (
            json!({ "request": "hold" }),
            "after `start`, once homing is over",
        ),
        (
            json!({ "request": "inject", "fault": { "kind": "stuck", "axis": 7 } }),
            "fault[0].axis",
        ),
        (
            json!({ "request": "inject", "fault": { "kind": "overrun" } }),
            "cophase run",
        ),
        (
            json!({ "request": "inject", "fault": { "kind": "sabotage" } }),
            "sabotage",
        ),
    ] {
        let error = browser.request(request).expect_err(reason);
        assert!(error.contains(reason), "{error}");
    }
    browser
        .socket
        .send(Message::text("{\"id\": 9, \"request\": \"explode\"}"))
        .unwrap();
    let reply = browser.wait(|report| report["type"] == "reply" && report["id"] == 9);
    assert!(
        reply["error"].as_str().unwrap().contains("explode"),
        "{reply}"
    );
}

/// Samples arrive complete, in batches that follow each other tick by tick.
#[test]
fn sample_batches_are_contiguous() {
    let served = Served::new();
    let mut browser = served.browser();
    let hello = browser.wait(|report| report["type"] == "hello");
    let columns = hello["columns"].as_array().unwrap().len();
    let mut next = None;
    let mut samples = 0;
    while samples < 4000 {
        let Message::Binary(batch) = browser.socket.read().unwrap() else {
            continue;
        };
        let word = |i: usize| u32::from_le_bytes(batch[4 * i..4 * i + 4].try_into().unwrap());
        let (tick, every, count) = (word(0), word(1), word(2));
        assert_eq!(every, 1);
        assert_eq!(word(3) as usize, columns);
        assert_eq!(batch.len(), 16 + 8 * columns * count as usize);
        assert!(next.is_none_or(|next| next == tick), "{next:?}, {tick}");
        next = Some(tick + count);
        samples += count;
    }
    let status = browser.wait(|report| report["type"] == "status");
    assert_eq!(
        (&status["lost_samples"], &status["dropped_samples"]),
        (&json!(0), &json!(0))
    );
}
