//! The manoeuvre of `tests/peers` on the phased model level. `compare.py` there compares its results and times it.
//!
//! `peer MACHINE.json AXES METHOD STEPS_PER_TICK REPEATS` plays the manoeuvre `REPEATS` times, so that the process can be
//! timed. It prints one JSON object: the crank angles in rad at every sample, or the reason why it stopped. Methods have
//! the names of the library, such as `RK4`. Below one step a tick (0.5, 0.25), drives are commanded less often by this
//! factor.
//!
//! The fields turn at constant speed within a tick, in the way that drives lead rotors in a scene, with the same [`Driven`].

use std::error::Error;

use cophase_methods::friction::{Contact, DryFriction};
use cophase_methods::{Equations, Scheme, advance};
use host_sim::drives::PullOut;
use host_sim::drives::{Field, Motor, Stepper};
use host_sim::dynamics::{Body, Driven, MAX, Phased};
use host_sim::mechanism::slider_crank::SliderCrank;
use host_sim::mechanism::{Load, Platform};
use serde::Deserialize;
use serde_json::json;

/// Speed of the first point of the pull-out curve, rev/s. The curve is constant up to this point, so here it is constant
/// everywhere.
const ABOVE_ALL_HZ: f64 = 1e4;

#[derive(Deserialize)]
struct Machine {
    crank_radius_m: f64,
    rod_length_m: f64,
    load_kg: f64,
    tilt_inertia_kgm2: f64,
    mount_radius_m: f64,
    gravity_mps2: f64,
    rotor_inertia_kgm2: f64,
    rod_n_per_m: f64,
    cycles_per_turn: f64,
    damping_nms: f64,
    torque_nm: Vec<f64>,
    friction_nm: Vec<f64>,
    friction_speed_rad_s: f64,
    offset_deg: Vec<f64>,
    speed_hz: f64,
    ramp_s: f64,
    hold_s: f64,
    tick_s: f64,
    ticks_per_sample: u32,
}

/// The machine with friction that reverses smoothly over a speed, as the other two sides have it.
struct Smoothed<'a> {
    driven: &'a Driven,
    friction_speed_rad_s: f64,
}

impl Equations for Smoothed<'_> {
    fn dimension(&self) -> usize {
        self.driven.dimension()
    }

    fn rates(&self, t_s: f64, state: &[f64], rates: &mut [f64]) {
        let speeds = self.driven.speeds();
        let mut bounds = [[0.0; 2]; MAX];
        self.driven.bounds(state, &mut bounds);
        let mut contacts = [Contact::Sticks; MAX];
        for ((contact, bounds), &speed) in contacts.iter_mut().zip(bounds).zip(speeds) {
            let part = (state[speed] / self.friction_speed_rad_s).tanh();
            *contact = Contact::Free(bounds[0] * part);
        }
        let contacts = &contacts[..speeds.len()];
        self.driven.rates_with(t_s, state, contacts, rates);
    }

    fn is_second_order(&self) -> bool {
        self.driven.is_second_order()
    }
}

impl Machine {
    fn driven(&self, axes: usize) -> Result<Driven, Box<dyn Error>> {
        let body = Body {
            mechanism: SliderCrank::new(self.crank_radius_m, self.rod_length_m)?.into(),
            load: Load {
                mass_kg: self.load_kg,
                gravity_mps2: self.gravity_mps2,
                platform: Platform::Above,
            },
            tilt_inertia_kgm2: self.tilt_inertia_kgm2,
            rotors_kgm2: vec![self.rotor_inertia_kgm2; axes],
            mount_radius_m: self.mount_radius_m,
            rod_n_per_m: self.rod_n_per_m,
            friction_nm: self.friction_nm[..axes].to_vec(),
        };
        let motors = self.torque_nm[..axes]
            .iter()
            .map(|&torque_nm| {
                Ok(Motor::Stepper(Stepper {
                    pull_out: PullOut::new(&[(ABOVE_ALL_HZ, torque_nm)])?,
                    cycles_per_turn: self.cycles_per_turn,
                    damping_nms: self.damping_nms,
                }))
            })
            .collect::<Result<Vec<_>, Box<dyn Error>>>()?;
        let mut driven = Driven::new(Box::new(Phased::new(body)), motors);
        driven.energised = true;
        Ok(driven)
    }

    fn smoothed<'a>(&self, driven: &'a Driven) -> Smoothed<'a> {
        Smoothed {
            driven,
            friction_speed_rad_s: self.friction_speed_rad_s,
        }
    }

    /// Returns the angle of a field at a time: its speed rises as 3u² − 2u³, and is then constant.
    fn turned_rad(&self, t_s: f64) -> f64 {
        let omega = self.speed_hz * std::f64::consts::TAU;
        let u = (t_s / self.ramp_s).min(1.0);
        omega * (self.ramp_s * u * u * u * (1.0 - 0.5 * u) + (t_s - self.ramp_s).max(0.0))
    }

    fn ticks(&self) -> u32 {
        ((self.ramp_s + self.hold_s) / self.tick_s).round() as u32
    }

    /// Plays the manoeuvre from rest. Returns the angles at every sample.
    fn play(
        &self,
        driven: &mut Driven,
        scheme: Scheme,
        steps: u32,
    ) -> Result<Vec<f64>, Box<dyn Error>> {
        let axes = driven.angles();
        let step_s = self.tick_s / f64::from(steps);
        let mut method = scheme.prepare(&self.smoothed(driven), step_s)?;
        let offsets_rad: Vec<f64> = self.offset_deg.iter().map(|deg| deg.to_radians()).collect();
        let mut state = vec![0.0; 2 * axes];
        state[..axes].copy_from_slice(&offsets_rad[..axes]);
        let mut samples = Vec::with_capacity((axes as u32 * self.ticks()) as usize);
        for tick in 1..=self.ticks() {
            let from_rad = self.turned_rad(f64::from(tick - 1) * self.tick_s);
            let to_rad = self.turned_rad(f64::from(tick) * self.tick_s);
            for (field, offset_rad) in driven.fields.iter_mut().zip(&offsets_rad) {
                *field = Field {
                    alpha_rad: from_rad + offset_rad,
                    omega_rad_s: (to_rad - from_rad) / self.tick_s,
                    torque_nm: 0.0,
                };
            }
            let smoothed = self.smoothed(driven);
            advance(method.as_mut(), &smoothed, 0.0, steps, &mut state)?;
            if tick % self.ticks_per_sample == 0 {
                samples.extend_from_slice(&state[..axes]);
            }
        }
        Ok(samples)
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [machine, axes, method, steps, repeats] = arguments.as_slice() else {
        return Err("peer MACHINE.json AXES METHOD STEPS_PER_TICK REPEATS".into());
    };
    let mut machine: Machine = serde_json::from_str(&std::fs::read_to_string(machine)?)?;
    let steps: f64 = steps.parse()?;
    let ticks_a_step = (1.0 / steps).round().max(1.0);
    machine.tick_s *= ticks_a_step;
    machine.ticks_per_sample /= ticks_a_step as u32;
    let steps = steps.round().max(1.0) as u32;
    let scheme = Scheme::ALL
        .into_iter()
        .find(|scheme| scheme.facts().name == method)
        .ok_or_else(|| format!("no method is named {method}"))?;
    let mut driven = machine.driven(axes.parse()?)?;
    let mut samples = Vec::new();
    for _ in 0..repeats.parse::<u32>()? {
        match machine.play(&mut driven, scheme, steps) {
            Ok(played) => samples = played,
            Err(error) => {
                println!("{}", json!({ "error": error.to_string() }));
                return Ok(());
            }
        }
    }
    println!("{}", json!({ "alpha_rad": samples }));
    Ok(())
}
