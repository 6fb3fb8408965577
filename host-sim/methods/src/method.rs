//! Interface of every method: its properties, and a step.
//!
//! A file of [`methods`](crate::methods) has a `Rule`, which computes the next state, and the memory for that. `Fixed` has the
//! parts that all methods share.

use core::fmt;

use crate::rule::Rule;
use crate::{Equations, Facts, Refused, StepError, friction_step};

/// Method for one machine and one step length. It advances a state by that step.
///
/// A step allocates nothing and depends on its arguments alone: the same input gives the same bits.
pub trait Method: fmt::Debug {
    /// Properties of the method.
    fn facts(&self) -> &'static Facts;

    /// Step h, s.
    fn step_s(&self) -> f64;

    /// Replaces `y`, the state at `t_s`, by the state one step later.
    ///
    /// `equations` must be those that the method was prepared for. Panics if their dimension differs, or that of `y`.
    /// On an error, `y` is unchanged.
    fn step(&mut self, equations: &dyn Equations, t_s: f64, y: &mut [f64])
    -> Result<(), StepError>;

    /// Returns a copy of the method with its memory.
    fn clone_box(&self) -> Box<dyn Method>;
}

impl Clone for Box<dyn Method> {
    fn clone(&self) -> Self {
        (**self).clone_box()
    }
}

/// Makes `steps` steps from `t0_s` on. The time of each is t0 + i h, so rounding errors do not accumulate.
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

/// Method: a rule with a fixed step.
#[derive(Clone, Debug)]
pub(crate) struct Fixed<R> {
    rule: R,
    step_s: f64,
    next: Vec<f64>,
    /// Memory for dry friction, if the machine has any.
    friction: Option<friction_step::Memory>,
}

impl<R: Rule> Fixed<R> {
    /// Refuses a step that is not finite and above 0, and equations that lack the required structure or that the rule
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
            friction: equations
                .friction()
                .map(|_| friction_step::Memory::new(equations.dimension())),
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
        match equations.friction() {
            None => self
                .rule
                .step(equations, t_s, self.step_s, y, &mut self.next)?,
            Some(machine) => friction_step::Step {
                rule: &mut self.rule,
                memory: (self.friction).get_or_insert_with(|| friction_step::Memory::new(y.len())),
                equations,
                machine,
            }
            .make(t_s, self.step_s, y, &mut self.next)?,
        }
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
