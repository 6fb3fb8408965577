//! Requests of browsers: the browsers that may make each request, and its form on the link.

use cophase_link::message::{ControlRequest, File, Request as LinkRequest};
use cophase_scene::file::FaultAt;
use serde_json::Value;

use super::bench::Bench;
use super::request::Request;
use crate::link::connection::Connection;
use crate::link::error::LinkError;

impl Bench {
    /// Restarts the controller. The browser that commanded it keeps control.
    fn restart(&mut self) -> Result<(), LinkError> {
        self.send_batch();
        let identity = self.link.restart(&self.identity, &LinkRequest::Restart)?;
        // A board begins a new log. The hub of a simulated controller continues its log.
        let last = self.link.events(0)?.last().map(|event| event.number + 1);
        let first = last.filter(|_| self.link.is_simulated()).unwrap_or(0);
        self.forget(first);
        self.begin_again(identity)?;
        self.control(ControlRequest::Take)
    }

    pub(super) fn control(&mut self, request: ControlRequest) -> Result<(), LinkError> {
        self.link
            .repeatable("control", &LinkRequest::Control(request))
    }

    /// Carries out a request of a browser. A stop passes no bench.
    pub(super) fn request(&mut self, id: u32, request: &Request) -> Result<(), String> {
        let text = |error: LinkError| error.to_string();
        match request {
            Request::TakeControl => {
                if self.browsers.owner().is_some() {
                    self.browsers.check_control(id)?;
                }
                self.control(ControlRequest::Take).map_err(text)?;
                self.browsers.set_owner(Some(id));
                return Ok(());
            }
            _ => self.browsers.check_control(id)?,
        }
        let name = request.name();
        let link = &mut self.link;
        match request {
            Request::TakeControl | Request::Stop { .. } => Ok(()),
            Request::ReleaseControl => {
                self.browsers.set_owner(None);
                self.control(ControlRequest::Release)
            }
            Request::Arm => link.repeatable(name, &LinkRequest::Arm),
            Request::Disarm => link.repeatable(name, &LinkRequest::Disarm),
            Request::Start => link.command(name, &LinkRequest::Start),
            Request::Home => link.command(name, &LinkRequest::Home),
            Request::Jog => link.command(name, &LinkRequest::Jog),
            Request::Hold => link.repeatable(name, &LinkRequest::Hold),
            Request::Resume => link.repeatable(name, &LinkRequest::Resume),
            Request::Reset => link.command(name, &LinkRequest::Reset),
            Request::Override { permille } => {
                let permille = *permille;
                link.repeatable(name, &LinkRequest::Override { permille })
            }
            Request::Restart => self.restart(),
            Request::Load { text, program } => link
                .write_file(File::Program, program)
                .map(|()| text.clone_into(&mut self.text)),
            Request::Inject { fault } => inject(link, fault),
        }
        .map_err(text)
    }
}

/// Injects a fault, whose keys are those of a scene's `[[fault]]`. It begins now.
fn inject(link: &mut Connection, fault: &serde_json::Map<String, Value>) -> Result<(), LinkError> {
    let mut fault = fault.clone();
    fault.insert("at_s".to_owned(), 0.0.into());
    let fault: FaultAt = serde_json::from_value(Value::Object(fault))
        .map_err(|error| LinkError::Input(format!("the fault is not understood: {error}")))?;
    link.inject(&fault)
}
