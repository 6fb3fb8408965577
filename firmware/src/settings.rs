//! temp
use cophase_core::settings::*;
use cophase_core::controller::Controller;
use cophase_core::program::*;
use embassy_rp::Peri;
use embassy_rp::peripherals::FLASH;
pub struct Setup { pub axes: [AxisSettings; 6] , pub n: usize}
const AX: AxisSettings = AxisSettings{drive: DriveKind::Stepper, steps_per_turn: 3200, reversed:false, ratio:(1,1), offset_turns:0.0, index_turns:None, trim_limit_turns:0.01, trim_rate_hz:0.1, rotor_inertia_kgm2:0.0};
pub static SETUP: Setup = Setup{ axes: [AX;6], n: 6};
impl Setup {
    pub fn axes_count(&self) -> usize { self.n }
    pub fn index_width_cycles(&self) -> u32 { 250 }
    pub fn controller<const N: usize>(&self) -> Result<Controller<N>, SettingsError> {
        let s = Settings::<N> { tick_hz: 2000, machine: MachineSettings{crank_radius_m:0.02,lambda:0.3,load_kg:5.0,platform:Platform::Below,gravity_mps2:9.80665,mount_radius_m:0.2},
          limits: LimitSettings{speed_hz:60.0,acceleration_hz_per_s:400.0,jerk_hz_per_s2:40000.0,creep_hz:1.0,bands:heapless::Vec::new()},
          pulse: PulseSettings{width_ns:400.0,dir_setup_ns:200.0,dir_hold_ns:200.0}, axes: core::array::from_fn(|_| AX),
          drift: DriftSettings{tilt_limit_mrad:3.0,warp_limit_deg:3.0,common_limit_deg:20.0}, park_turns:0.0, settle_s:0.01 };
        let mut b = s.program_builder();
        b.segment(SegmentSettings{amax_mps2:1000.0, ramp_s:0.1, hold_s:0.2, shape: Shape::Smooth})?;
        b.segment(SegmentSettings{amax_mps2:0.0, ramp_s:0.1, hold_s:0.0, shape: Shape::Smooth})?;
        Controller::new(&s, b.build()?)
    }
}
pub fn load(_f: Peri<'static, FLASH>) -> Option<&'static Setup> { Some(&SETUP) }
