use cophase_link::board::{BOARDS, Board, Rp2040};
fn main() {
    let file = std::fs::read(std::env::args().nth(1).unwrap()).unwrap();
    let mut s = cophase_link::decode(&file).unwrap();
    s.clock_hz = Rp2040::CLOCK_HZ;
    if let Err(e) = s.check() {
        eprintln!("{e}");
        std::process::exit(2);
    }
    let b = BOARDS[0];
    match (b.check)(&s) {
        Ok(()) => println!(
            "Longest tick on the {} board: at most {:.0} of {} cycles.",
            b.name,
            (b.tick_cycles)(&s, s.tick_hz).ceil(),
            b.clock_hz / s.tick_hz
        ),
        Err(e) => {
            eprintln!("cophase: scene.toml: {e}");
            std::process::exit(2);
        }
    }
}
