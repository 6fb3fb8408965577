//! `fidelity = "auto"`: bounds hold, and no rung is taken that is not needed.

use host_sim::fidelity::{Output, answers, check};
use host_sim::scene::{Checked, library};

#[test]
fn table() {
    for built_in in library::SCENES {
        let checked = Checked::new(built_in.scene()).unwrap();
        let began = std::time::Instant::now();
        let rungs = host_sim::fidelity::available(&checked);
        println!("{}: {:?} -> {:?}: {}", built_in.name, rungs, checked.fidelity, checked.why);
        let bounds = host_sim::fidelity::bounds(&checked);
        let Ok(bounds) = bounds else { println!("   {:?}", bounds.err()); continue };
        println!("   {:?} in {:?}", bounds.worst(), began.elapsed());
        let top = answers(&checked, *rungs.last().unwrap()).unwrap();
        for rung in rungs {
            let began = std::time::Instant::now();
            let found = answers(&checked, rung).unwrap();
            print!("   {:12} {:8.1?} ms ", rung.name(), began.elapsed().as_secs_f64()*1e3);
            for output in Output::ALL {
                let off = found.of(output).zip(top.of(output)).map(|(a, b)| output.difference(a, b));
                print!("{} {:.3?} off {:.3?} <= {:.3}; ", output.key(), found.of(output).unwrap_or(f64::NAN), off.unwrap_or(f64::NAN), bounds.of(rung, output));
            }
            println!();
        }
        let after = check(checked).unwrap();
        println!("   => {:?} {} {:?}", after.fidelity, after.why, after.choice.map(|c| c.judged));
    }
}
