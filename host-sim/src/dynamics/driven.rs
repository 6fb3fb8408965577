//! A machine with its motors, as equations that an integration method can advance.
//!
//! Within a control tick the drives' command to the motors advances evenly: a field at an angle turns at a constant speed.
//! Microsteps are not modelled, because they are smaller than anything that this model resolves.

use cophase_methods::Equations;
use cophase_methods::friction::{self, Contact, Contacts, DryFriction};

use super::corners::{FREEDOMS, MAX};
use super::modes::{Bound, Mode};
use super::{Body, Dynamics, Frame, FrameMotion};
use crate::drives::{Field, Motor};
use crate::pose::Pose;

/// Motors on a machine. Time counts from the start of the control tick.
#[derive(Clone, Debug)]
pub struct Driven {
    machine: Box<dyn Dynamics>,
    motors: Vec<Motor>,
    /// Number of positions in the state.
    positions: usize,
    /// For each motor, the index of its angle among the positions.
    angles: [usize; MAX],
    /// For each motor, the index of the first motor that is equal to it and has the same angle.
    equal_to: [usize; MAX],
    /// Index and integral time, s, of each motor that integrates, in the order of the state.
    integrals: Vec<(usize, f64)>,
    /// Rotors that are locked, whatever torque acts on them.
    locked: [bool; MAX],
    /// Components of the state that are speeds with dry friction, in the order of the angles.
    sliding: Vec<usize>,
    /// Dry friction at each of them, N·m.
    friction_nm: Vec<f64>,
    /// True if the machine resists forward rotation.
    resists: bool,
    /// Angle of each field at the start of the tick, and its speed during the tick.
    pub fields: Vec<Field>,
    /// Load torque on each crank in addition to its share of the machine, N·m. Positive against forward rotation.
    pub loads_nm: [f64; MAX],
    /// True if the drives are on. Without them only friction and the load act.
    pub energised: bool,
}

impl Driven {
    /// Creates a machine with one motor per axis and the drives off.
    pub fn new(machine: Box<dyn Dynamics>, motors: Vec<Motor>) -> Self {
        let integral = |(i, motor): (usize, &Motor)| Some((i, motor.integral_s()?));
        let angles: [usize; MAX] = std::array::from_fn(|i| machine.angle(i));
        let is_equal =
            |j: usize, i: usize| angles[j] == angles[i] && motors.get(j) == motors.get(i);
        let first = |i: usize| (0..i).find(|&j| is_equal(j, i)).unwrap_or(i);
        let mut driven = Self {
            fields: vec![Field::default(); motors.len()],
            equal_to: std::array::from_fn(first),
            positions: machine.positions(),
            angles,
            locked: [false; MAX],
            sliding: Vec::with_capacity(MAX),
            friction_nm: Vec::with_capacity(MAX),
            resists: false,
            integrals: motors.iter().enumerate().filter_map(integral).collect(),
            machine,
            motors,
            loads_nm: [0.0; MAX],
            energised: false,
        };
        assert_eq!(
            driven.machine.rotors_kgm2().len(),
            driven.motors.len(),
            "a motor an axis"
        );
        driven.list_sliding();
        driven
    }

    /// Platform that the cranks carry; `None` if they move something else.
    pub fn body(&self) -> Option<&Body> {
        self.machine.body()
    }

    /// Motors, one per axis.
    pub fn motors(&self) -> &[Motor] {
        &self.motors
    }

    /// Number of angles at the start of the state.
    pub fn angles(&self) -> usize {
        self.machine.angles()
    }

    /// Number of positions in the state, including the angles. The same number of speeds follows.
    pub fn positions(&self) -> usize {
        self.positions
    }

    /// True if the platform has no equations of its own, because its position follows from the cranks.
    pub fn is_geometric(&self) -> bool {
        self.machine.is_geometric()
    }

    /// The frame, if it moves.
    pub fn frame(&self) -> Option<&Frame> {
        self.machine.frame()
    }

    /// Returns the state in which the cranks stand at these angles, one per axis, and platform and frame are at rest.
    pub fn at_rest(&self, alpha_rad: &[f64]) -> Vec<f64> {
        let mut state = vec![0.0; self.dimension()];
        let angles = self.angles();
        state[..angles].copy_from_slice(&alpha_rad[..angles]);
        self.machine.rest(alpha_rad, &mut state[..self.positions()]);
        state
    }

    /// Angle of crank `i`, rad, in a state.
    pub fn alpha_rad(&self, state: &[f64], i: usize) -> f64 {
        state[self.angle(i)]
    }

    /// Index of the angle of crank `i` among the positions.
    pub(crate) fn angle(&self, i: usize) -> usize {
        self.angles[i]
    }

    /// Locks rotor `i`, or releases it. On a single shaft this has no effect.
    pub fn hold(&mut self, i: usize, held: bool) {
        let turns_alone = self.angles() == self.motors.len();
        if self.locked[i] != held && turns_alone {
            self.locked[i] = held;
            self.list_sliding();
        }
    }

    fn list_sliding(&mut self) {
        self.sliding.clear();
        self.friction_nm.clear();
        let (positions, nowhere) = (self.positions(), vec![0.0; self.positions()]);
        for i in 0..self.angles() {
            let friction_nm = self.machine.friction_nm(i);
            self.resists = self.machine.resistance_nm(i, &nowhere).is_some();
            if (friction_nm > 0.0 || self.resists) && !self.locked[i] {
                self.sliding.push(positions + i);
                self.friction_nm.push(friction_nm);
            }
        }
    }

    /// Starts a control tick of `tick_s` in a state. Sampled drive laws compute their torques for the tick.
    pub fn begin_tick(&mut self, state: &[f64], tick_s: f64) {
        let positions = self.positions();
        let (q, v) = state[..2 * positions].split_at(positions);
        let fields = self.energised.then_some(&self.fields[..]);
        self.machine.begin_tick(fields, q, v, tick_s);
    }

    /// Upper bound of the fastest mode.
    pub fn fastest_mode(&self) -> Mode {
        let rotors = Bound::of_rotors(&self.motors, self.machine.rotors_kgm2());
        self.machine.fastest_mode(rotors).mode()
    }

    /// Modes of individual parts. They are slower than [`Driven::fastest_mode`], and may be damped less. A method that is
    /// stable only because of damping must be checked against these as well.
    pub fn own_modes(&self) -> Vec<Mode> {
        let mut modes = Bound::rotors(&self.motors, self.machine.rotors_kgm2());
        modes.extend(self.frame().into_iter().flat_map(Bound::layers));
        modes.retain(|mode| mode.omega_rad_s > 0.0);
        // Equal motors on equal rotors have equal modes.
        modes.dedup();
        modes
    }

    /// Torque of each motor, N·m, in a state at a time.
    pub fn torques_nm(&self, t_s: f64, state: &[f64]) -> [f64; MAX] {
        let mut torques = [0.0; MAX];
        if !self.energised {
            return torques;
        }
        if let Some(law_nm) = self.machine.law_nm() {
            return law_nm;
        }
        let positions = self.positions();
        let mut integral_nm = [0.0; MAX];
        for (&(i, _), &integral) in self.integrals.iter().zip(&state[2 * positions..]) {
            integral_nm[i] = integral;
        }
        let (angles, speeds) = state[..2 * positions].split_at(positions);
        let drives = self.motors.iter().zip(&self.fields).zip(integral_nm);
        let torque_nm = |motor: &Motor, field: &Field, alpha_rad, omega_rad_s, integral_nm| {
            let field = Field {
                alpha_rad: field.alpha_rad + field.omega_rad_s * t_s,
                ..*field
            };
            motor.torque_nm(&field, alpha_rad, omega_rad_s, integral_nm)
        };
        for (i, ((motor, field), integral)) in drives.enumerate() {
            let at = self.angle(i);
            // They give equal torques under equal commands. On a single shaft most motors are equal.
            let first = self.equal_to[i];
            let is_alike =
                first < i && integral_nm[first] == integral && self.fields[first] == *field;
            torques[i] = if is_alike {
                torques[first]
            } else {
                torque_nm(motor, field, angles[at], speeds[at], integral)
            };
        }
        torques
    }

    /// Returns the rates of a state in which the motors give these torques, N·m. See [`Equations::rates`].
    pub fn rates_under(&self, torques_nm: &[f64; MAX], t_s: f64, state: &[f64], rates: &mut [f64]) {
        let contacts = Contacts::in_state(self, t_s, state, rates);
        self.rates_of(torques_nm, &contacts, state, rates);
    }

    /// Computes the rates of a state under these torques of the motors, with these contacts.
    fn rates_of(
        &self,
        torques_nm: &[f64; MAX],
        contacts: &[Contact],
        state: &[f64],
        rates: &mut [f64],
    ) {
        let n = self.positions();
        let (mut net, mut held) = (*torques_nm, self.locked);
        for (net, load) in net.iter_mut().zip(&self.loads_nm) {
            *net -= load;
        }
        let each = self.sliding.iter().zip(&self.friction_nm).zip(contacts);
        for ((speed, friction_nm), contact) in each {
            let i = speed - n;
            match contact {
                Contact::Forwards if self.resists => {
                    net[i] -= friction_nm + self.machine.resistance_nm(i, state).unwrap_or(0.0);
                }
                Contact::Forwards => net[i] -= friction_nm,
                Contact::Backwards => net[i] += friction_nm,
                Contact::Sticks => held[i] = true,
                Contact::Free(torque_nm) => net[i] += torque_nm,
            }
        }
        let (q, rest) = state.split_at(n);
        let (v, integrals) = rest.split_at(n);
        let (speeds, rest) = rates.split_at_mut(n);
        let (accelerations, integral_rates) = rest.split_at_mut(n);
        speeds.copy_from_slice(v);
        self.machine.accelerations(q, v, &net, &held, accelerations);
        let of_each = self.integrals.iter().zip(integrals).zip(integral_rates);
        for ((&(i, integral_s), integral), rate) in of_each {
            *rate = if self.energised {
                (torques_nm[i] - self.fields[i].torque_nm - integral) / integral_s
            } else {
                0.0
            };
        }
    }

    /// Clears the servos' integrals, as a drive does when it is switched off.
    pub fn forget(&self, state: &mut [f64]) {
        state[2 * self.positions()..].fill(0.0);
    }

    /// Mean speed and mean acceleration of the cranks, rad/s and rad/s², in a state with these rates.
    pub fn mean_motion(&self, state: &[f64], rates: &[f64]) -> (f64, f64) {
        let (angles, positions) = (self.angles(), self.positions());
        let mean = |values: &[f64]| values.iter().sum::<f64>() / angles as f64;
        let speeds = positions..positions + angles;
        (mean(&state[speeds.clone()]), mean(&rates[speeds]))
    }

    /// Pose of the part that the shafts move, in a state with these rates. `None` if it follows from the shafts' angles.
    pub fn pose(&self, state: &[f64], rates: &[f64]) -> Option<Pose> {
        let n = self.positions();
        let (q, v, a) = (&state[..n], &state[n..2 * n], &rates[n..2 * n]);
        self.machine.pose(q, v, a)
    }

    /// Position of the platform in a state. `None` if it follows the shaft, or a plant moves it.
    pub fn place(&self, state: &[f64]) -> Option<[f64; FREEDOMS]> {
        self.machine.place(&state[..self.positions()])
    }

    /// Motion of the frame, if it moves.
    pub fn frame_motion(&self, state: &[f64]) -> Option<FrameMotion> {
        let frame = self.frame()?;
        let n = self.positions();
        let from = n - frame.freedoms();
        Some(frame.motion(&state[from..n], &state[n + from..2 * n]))
    }

    /// Kinetic and potential energy, J. It is constant without friction, damping and motors.
    pub fn energy_j(&self, state: &[f64]) -> f64 {
        let (q, v) = state[..2 * self.positions()].split_at(self.positions());
        self.machine.energy_j(q, v)
    }
}

impl Equations for Driven {
    fn dimension(&self) -> usize {
        2 * self.positions() + self.integrals.len()
    }

    fn rates(&self, t_s: f64, state: &[f64], rates: &mut [f64]) {
        friction::rates(self, t_s, state, rates);
    }

    fn friction(&self) -> Option<&dyn DryFriction> {
        (!self.sliding.is_empty()).then_some(self)
    }

    fn is_second_order(&self) -> bool {
        self.integrals.is_empty()
    }
}

impl DryFriction for Driven {
    fn speeds(&self) -> &[usize] {
        &self.sliding
    }

    fn bounds(&self, state: &[f64], bounds: &mut [[f64; 2]]) {
        let n = self.positions();
        let each = self.sliding.iter().zip(&self.friction_nm);
        for (bounds, (speed, &friction_nm)) in bounds.iter_mut().zip(each) {
            let resistance_nm = self.machine.resistance_nm(speed - n, state).unwrap_or(0.0);
            *bounds = [-friction_nm - resistance_nm, friction_nm];
        }
    }

    fn rates_with(&self, t_s: f64, state: &[f64], contacts: &[Contact], rates: &mut [f64]) {
        self.rates_of(&self.torques_nm(t_s, state), contacts, state, rates);
    }
}
