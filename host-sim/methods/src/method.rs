//! What every method is: facts that can be relied on, and a step.
//!
//! A file of [`methods`](crate::methods) has a `Rule`: what makes one state of another, and the memory that takes. All else
//! that methods have in common is `Fixed`, written once.

use core::fmt;

use crate::{Equations, Facts, Refused, StepError};

/// A method, made for one machine and one length of step, that moves a state on by that step.
///
/// Stepping allocates nothing and depends on nothing but its arguments: same input, same bits.
pub trait Method: fmt::Debug {
    /// What is known of the method.
    fn facts(&self) -> &'static Facts;

    /// The step h, s.
    fn step_s(&self) -> f64;

    /// Replaces `y`, the state at `t_s`, by the state one step later.
    ///
    /// `equations` must be those the method was made for; panics if their dimension differs, or that of `y`.
    /// On an error `y` is as it was.
    fn step(&mut self, equations: &dyn Equations, t_s: f64, y: &mut [f64])
    -> Result<(), StepError>;

    /// Copy of the method with its memory.
    fn clone_box(&self) -> Box<dyn Method>;
}

impl Clone for Box<dyn Method> {
    fn clone(&self) -> Self {
        (**self).clone_box()
    }
}

/// Makes `steps` steps from `t0_s` on. The time of each is t0 + i h, not a sum that gathers rounding.
pub fn advance(
    method: &mut dyn Method,
    equations: &dyn Equations,
    t0_s: f64,
    steps: u32,
    y: &mut [f64],
) -> Result<(), StepError> {
    for i in 0..steps {
        method.step(equations, t0_s + f64::from(i) * method.step_s(), y)?;
    }
    Ok(())
}

/// What a method does in a step, and nothing else.
pub(crate) trait Rule: Clone + fmt::Debug + Sized + 'static {
    /// What is known of it.
    const FACTS: &'static Facts;

    /// Its memory, for equations that offer what it needs and a step that is finite and above 0.
    fn new(equations: &dyn Equations, step_s: f64) -> Result<Self, Refused>;

    /// Writes the state at `t_s` + `h` into `next`, from the state `y` at `t_s`. Whether it is finite is looked at
    /// afterwards.
    fn step(
        &mut self,
        equations: &dyn Equations,
        t_s: f64,
        h: f64,
        y: &[f64],
        next: &mut [f64],
    ) -> Result<(), StepError>;
}

/// A rule at a fixed step: a method.
#[derive(Clone, Debug)]
pub(crate) struct Fixed<R> {
    rule: R,
    step_s: f64,
    next: Vec<f64>,
}

impl<R: Rule> Fixed<R> {
    /// Refuses a step that is not finite and above 0, equations that lack what the rule needs, and what the rule itself
    /// refuses.
    pub fn prepare(equations: &dyn Equations, step_s: f64) -> Result<Box<dyn Method>, Refused> {
        if !(step_s.is_finite() && step_s > 0.0) {
            return Err(Refused::Step(step_s));
        }
        if !R::FACTS.needs.met_by(equations) {
            return Err(Refused::Structure {
                method: R::FACTS.name,
                needs: R::FACTS.needs,
                instead: "take RK4, or an implicit method if they are stiff",
            });
        }
        Ok(Box::new(Self {
            rule: R::new(equations, step_s)?,
            step_s,
            next: vec![0.0; equations.dimension()],
        }))
    }
}

impl<R: Rule> Method for Fixed<R> {
    fn facts(&self) -> &'static Facts {
        R::FACTS
    }

    fn step_s(&self) -> f64 {
        self.step_s
    }

    fn step(
        &mut self,
        equations: &dyn Equations,
        t_s: f64,
        y: &mut [f64],
    ) -> Result<(), StepError> {
        self.rule
            .step(equations, t_s, self.step_s, y, &mut self.next)?;
        if let Some(component) = self.next.iter().position(|value| !value.is_finite()) {
            return Err(StepError::NotFinite { t_s, component });
        }
        y.copy_from_slice(&self.next);
        Ok(())
    }

    fn clone_box(&self) -> Box<dyn Method> {
        Box::new(self.clone())
    }
}
