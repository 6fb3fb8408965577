//! Controllers that lose replies or send impossible ones, and texts and addresses that are not what they seem.

use std::process::Output;

use crate::support::controller::{self, Answer, Stored};
use assert_cmd::Command;
use cophase_link::message::{
    Event, EventRecord, Identity, Name, Refusal, ReplyBody, Request, text,
};

const SCENE: &str = "name = \"hostile\"\n\
     fidelity = \"kinematic\"\n\
     [machine]\ncrank_radius_mm = 12\nlambda = 0.3\nload_kg = 5\n\
     [control]\nsettle_s = 0.01\n\
     [limits]\nspeed_hz = 20\nacceleration_hz_per_s = 100\njerk_hz_per_s2 = 4000\nhoming_speed_hz = 5\n\
     [axes]\ncount = 3\ndrive = \"stepper\"\nsteps_per_turn = 3200\n\
     [[program]]\namax_g = 2\nramp_s = 0.2\nhold_s = 0.1\n";

fn cophase(arguments: &[&str]) -> Output {
    Command::cargo_bin("cophase")
        .unwrap()
        .args(arguments)
        .output()
        .unwrap()
}

/// Runs `cophase link` on a controller with these answers. Returns status and output.
fn link(
    stored: Stored,
    answer: impl for<'a> Fn(&'a Stored, &Request<'_>) -> Answer<'a> + Send + 'static,
    arguments: &[&str],
) -> (Option<i32>, String) {
    let (to, _) = controller::serve(stored, answer, |_| Ok(()));
    let output = cophase(&[&["link", "--to", &to], arguments].concat());
    let text = [output.stdout, output.stderr].concat();
    (output.status.code(), String::from_utf8(text).unwrap())
}

/// If this fails, an operator believes that a machine which may run does not.
#[test]
fn a_lost_reply_states_what_may_have_happened_and_how_to_find_out() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.toml");
    std::fs::write(&scene, SCENE).unwrap();
    let scene = scene.to_str().unwrap();
    let cases: [(&[&str], &str, [&str; 2]); 7] = [
        (
            &["start", "--yes"],
            "Start",
            ["the machine may be running", "`cophase link monitor`"],
        ),
        (
            &["home", "--yes"],
            "Home",
            ["the machine may be running", "`cophase link stop`"],
        ),
        (
            &["load", scene],
            "FinishWrite",
            ["the file may be stored", "`cophase link identify`"],
        ),
        (
            &["restart"],
            "Restart",
            ["may have restarted", "`cophase link identify`"],
        ),
        (
            &["stop"],
            "Stop",
            ["may still be running", "press its STOP"],
        ),
        (
            &["reset"],
            "Reset",
            ["the fault may have ended", "`cophase link monitor`"],
        ),
        (
            &["log"],
            "Events",
            [
                "nothing has changed",
                "check that a controller's server listens at",
            ],
        ),
    ];
    std::thread::scope(|threads| {
        for (arguments, lost, expected) in cases {
            threads.spawn(move || {
                let (status, said) = link(
                    Stored::new(SCENE),
                    move |stored, request| {
                        let is_lost = format!("{request:?}").starts_with(lost);
                        if is_lost {
                            None
                        } else {
                            stored.answer(request)
                        }
                    },
                    arguments,
                );
                assert_eq!(status, Some(2), "{lost}: {said}");
                for part in expected {
                    assert!(said.contains(part), "{lost}: {said}");
                }
            });
        }
    });
}

/// Checks that a host refuses a controller with this identity.
fn refuses(change: impl FnOnce(&mut Identity), problem: &str) {
    let mut stored = Stored::new(SCENE);
    change(&mut stored.identity);
    let (status, said) = link(
        stored,
        |stored, request| stored.answer(request),
        &["identify"],
    );
    assert_eq!(status, Some(2), "{said}");
    assert!(said.contains(problem), "{said}");
}

#[test]
fn impossible_numbers_of_a_controller_are_refused() {
    refuses(|identity| identity.version = 99, "protocol version 99, not");
    refuses(|identity| identity.axes = 7, "7 axes, outside 1 to 6");
    refuses(|identity| identity.axes = 0, "0 axes, outside 1 to 6");
    refuses(|identity| identity.tick_hz = 0, "a tick rate of 0 Hz");
    refuses(
        |identity| identity.tick_hz = 4_000_000_000,
        "outside 500 to 10000",
    );
    refuses(
        |identity| identity.only_axis = Some(6),
        "6 as its only axis",
    );
}

/// A controller that refused its settings may have no axes. Other settings can be loaded to it.
#[test]
fn a_controller_without_settings_is_accepted() {
    let mut stored = Stored::new(SCENE);
    (stored.identity.can_run, stored.identity.axes) = (false, 0);
    let (status, said) = link(
        stored,
        |stored, request| stored.answer(request),
        &["identify"],
    );
    assert_eq!(status, Some(0), "{said}");
}

/// If this fails, the test hangs, or the memory grows without a bound.
#[test]
fn files_and_logs_without_an_end_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.toml");
    std::fs::write(&scene, SCENE).unwrap();
    let load = ["load", scene.to_str().unwrap()];
    let chunk = |length: u32, bytes: &'static [u8]| {
        link(
            Stored::new(SCENE),
            move |stored, request| match request {
                Request::Read { .. } => Some(Ok(ReplyBody::Chunk { length, bytes })),
                _ => stored.answer(request),
            },
            &load,
        )
    };
    let cases: [(u32, &'static [u8], &str); 3] = [
        (
            u32::MAX,
            &[0; 256][..],
            "a file of 4294967295 bytes; the longest has",
        ),
        (100, &[], "0 bytes of a file of 100 bytes"),
        (100, &[0; 101], "101 bytes of a file of 100 bytes"),
    ];
    for (length, bytes, problem) in cases {
        let (status, said) = chunk(length, bytes);
        assert_eq!(status, Some(2), "{said}");
        assert!(said.contains(problem), "{said}");
    }
    let log = |first: fn(u32) -> u32| {
        link(
            Stored::new(SCENE),
            move |stored, request| match request {
                Request::Events { from } => {
                    let event = |i| EventRecord {
                        number: first(*from).wrapping_add(i),
                        tick: 0,
                        event: Event::Missed(i),
                    };
                    Some(Ok(ReplyBody::Events((0..8).map(event).collect())))
                }
                _ => stored.answer(request),
            },
            &["log"],
        )
    };
    let (status, said) = log(|from| from);
    assert_eq!(status, Some(0), "{said}");
    assert_eq!(said.lines().count(), 64, "{said}");
    let (status, said) = log(|_| 0);
    assert_eq!(status, Some(2), "{said}");
    assert!(said.contains("event 0 came where event 8"), "{said}");
}

/// If this fails, the name of a board or a scene can move the cursor of a terminal, or fake its title and its text.
#[test]
fn control_characters_are_not_sent_to_the_terminal() {
    let mut stored = Stored::new(SCENE);
    stored.identity.settings = Name::try_from("a\u{1b}[2Jb\u{9b}c").unwrap();
    let (_, said) = link(
        stored,
        |stored, request| match request {
            Request::Hold => Some(Err(Refusal::Rejected(text(&"no\u{1b}]0;title\u{7}")))),
            _ => stored.answer(request),
        },
        &["identify"],
    );
    assert!(said.contains("a\\u{1b}[2Jb\\u{9b}c"), "{said:?}");
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("\u{1b}[31m.toml");
    std::fs::write(&scene, SCENE.replace("hostile", "\\u001b[31mred")).unwrap();
    let out = folder.path().join("out");
    let outputs = [
        cophase(&[
            "run",
            scene.to_str().unwrap(),
            "--out",
            out.to_str().unwrap(),
        ]),
        cophase(&["run", "\u{1b}[31m"]),
        cophase(&["\u{1b}[31m"]),
    ];
    for output in outputs {
        let said = [output.stdout, output.stderr].concat();
        assert!(!said.is_empty());
        assert!(!said.contains(&0x1B), "{}", String::from_utf8_lossy(&said));
    }
}

#[test]
fn the_address_of_all_addresses_is_refused_in_every_form() {
    for address in ["0.0.0.0", "::", "::ffff:0.0.0.0", "0:0:0:0:0:ffff:0:0"] {
        let output = cophase(&["scope", "--to", "sim", "--listen", address]);
        assert_eq!(output.status.code(), Some(2), "{address}");
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(said.contains("give one address of this computer"), "{said}");
    }
}

#[test]
fn an_address_of_another_computer_is_not_taken_for_a_port_in_use() {
    let output = cophase(&["scope", "--to", "sim", "--listen", "192.0.2.1"]);
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(
        said.contains("give an address that this computer has"),
        "{said}"
    );
}
