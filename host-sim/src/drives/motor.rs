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
pub(super) trait TorqueLaw {
    /// True if torque is proportional to deflection and speed error below the limit, so that linear bounds apply.
    const IS_LINEAR: bool = true;

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
    fn most_nm(&self, omega_rad_s: f64) -> f64;
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
            /// True if linear bounds apply to its torque.
            pub fn is_linear(&self) -> bool {
                match self { $(Self::$Law(_) => $Law::IS_LINEAR,)* }
            }

            /// Torque on the rotor, N·m. `integral_nm` is z, and 0 if the motor has none.
            #[inline]
            pub fn torque_nm(&self, field: &Field, alpha_rad: f64, omega_rad_s: f64, integral_nm: f64) -> f64 {
                match self { $(Self::$Law(law) => law.torque_nm(field, alpha_rad, omega_rad_s, integral_nm),)* }
            }

            /// Integral time of the velocity loop, s, if there is one.
            pub fn integral_s(&self) -> Option<f64> {
                match self { $(Self::$Law(law) => law.integral_s(),)* }
            }

            /// Limit at which the drive clamps the torque, N·m, if it has one.
            pub fn limit_nm(&self) -> Option<f64> {
                match self { $(Self::$Law(law) => law.limit_nm(),)* }
            }

            /// Torque per speed error, N·m·s.
            pub fn damping_nms(&self) -> f64 {
                match self { $(Self::$Law(law) => law.damping_nms(),)* }
            }

            /// Softest and stiffest stiffness at a speed without load, N·m/rad.
            pub fn stiffness_nm(&self, omega_rad_s: f64) -> (f64, f64) {
                match self { $(Self::$Law(law) => law.stiffness_nm(omega_rad_s),)* }
            }

            /// Largest stiffness over all speeds, N·m/rad.
            pub fn stiffest_nm(&self) -> f64 {
                match self { $(Self::$Law(law) => law.stiffest_nm(),)* }
            }

            /// Following error at constant speed without load, rad.
            pub fn following_error_rad(&self, omega_rad_s: f64) -> f64 {
                match self { $(Self::$Law(law) => law.following_error_rad(omega_rad_s),)* }
            }

            /// Largest torque at a speed, N·m.
            pub fn most_nm(&self, omega_rad_s: f64) -> f64 {
                match self { $(Self::$Law(law) => law.most_nm(omega_rad_s),)* }
            }
        }
    };
}

pub(super) use motors;
