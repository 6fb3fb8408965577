//! Torque that a motor generates from its drive's command.

/// Command of a drive to its rotor, in crank angle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Field {
    /// Angle, rad.
    pub alpha_rad: f64,
    /// Speed, rad/s.
    pub omega_rad_s: f64,
    /// Torque feed-forward of a servo, N·m.
    pub torque_nm: f64,
}

/// A motor with its drive: its torque, and the figures that bound it.
pub trait TorqueLaw {
    /// True if small torques are proportional to deflection and speed error, so that linear bounds apply.
    fn is_linear(&self) -> bool {
        true
    }

    /// Torque on the rotor, N·m. `integral_nm` is z, and 0 if the motor has none.
    fn torque_nm(&self, field: &Field, alpha_rad: f64, omega_rad_s: f64, integral_nm: f64) -> f64;

    /// Integral time of the velocity loop, s, if there is one.
    fn integral_s(&self) -> Option<f64> {
        None
    }

    /// Limit at which the drive clamps the torque, N·m, if it has one.
    fn limit_nm(&self) -> Option<f64> {
        None
    }

    /// Torque per speed error, N·m·s.
    fn damping_nms(&self) -> f64;

    /// Softest and stiffest stiffness at a speed without load, N·m/rad.
    fn stiffness_nm(&self, omega_rad_s: f64) -> (f64, f64);

    /// Largest stiffness over all speeds, N·m/rad.
    fn stiffest_nm(&self) -> f64 {
        self.stiffness_nm(0.0).1
    }

    /// Following error at constant speed without load, rad.
    fn following_error_rad(&self, _omega_rad_s: f64) -> f64 {
        0.0
    }

    /// Largest torque at a speed, N·m.
    fn max_nm(&self, omega_rad_s: f64) -> f64;
}

/// Makes [`Motor`] from the list of all torque laws.
macro_rules! motors {
    ($($Law:ident),* $(,)?) => {
        /// Motor with its drive, by torque law.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Motor {
            $(
                #[doc = concat!("See [`", stringify!($Law), "`].")]
                $Law($Law),
            )*
        }

        impl Motor {
            /// Torque on the rotor, N·m. `integral_nm` is z, and 0 if the motor has none.
            #[inline] // the equations of motion call it in each evaluation, for each rotor
            pub fn torque_nm(&self, field: &Field, alpha_rad: f64, omega_rad_s: f64, integral_nm: f64) -> f64 {
                match self { $(Self::$Law(law) => law.torque_nm(field, alpha_rad, omega_rad_s, integral_nm),)* }
            }
        }

        /// The torque law has the other figures.
        impl std::ops::Deref for Motor {
            type Target = dyn TorqueLaw;

            fn deref(&self) -> &Self::Target {
                match self { $(Self::$Law(law) => law,)* }
            }
        }
    };
}

pub(super) use motors;
