//! One browser: its requests go to the bench, and its reports and samples come from a queue.

use std::io;
use std::net::TcpStream;
use std::sync::mpsc::{Receiver, Sender, sync_channel};
use std::time::Duration;

use tungstenite::protocol::{Role, WebSocketConfig};
use tungstenite::{Error, Message, WebSocket};

use super::bench::Job;
use super::browsers::Browser;

/// Greatest number of messages that wait for a browser: about four seconds of samples.
const QUEUE: usize = 256;

/// Longest wait of a read or a write, after which the other one has its turn.
const TURN: Duration = Duration::from_millis(4);

/// Longest request, bytes: a scene is no larger than 1 MiB, and JSON escapes some of its characters.
const REQUEST_BYTES: usize = 3 << 20;

/// Serves a browser until it leaves.
pub(super) fn serve(stream: TcpStream, jobs: &Sender<Job>) -> io::Result<()> {
    stream.set_read_timeout(Some(TURN))?;
    stream.set_write_timeout(Some(TURN))?;
    let address = stream.peer_addr()?;
    let config = WebSocketConfig::default()
        .max_message_size(Some(REQUEST_BYTES))
        .max_frame_size(Some(REQUEST_BYTES));
    let socket = WebSocket::from_raw_socket(stream, Role::Server, Some(config));
    let (queue, waiting) = sync_channel(QUEUE);
    let browser = Browser::new(address, queue);
    let id = browser.id;
    if jobs.send(Job::Joined(browser)).is_ok() {
        // The reason does not matter: the browser has left.
        let _ = exchange(socket, id, jobs, &waiting);
        let _ = jobs.send(Job::Left(id));
    }
    Ok(())
}

fn exchange(
    mut socket: WebSocket<TcpStream>,
    id: u32,
    jobs: &Sender<Job>,
    waiting: &Receiver<Message>,
) -> Result<(), Error> {
    let mut is_sent = true;
    loop {
        match socket.read() {
            Ok(Message::Text(text)) => {
                if jobs
                    .send(Job::Request(id, text.as_str().to_owned()))
                    .is_err()
                {
                    return Ok(());
                }
            }
            Ok(_) => {}
            Err(error) if is_turn_over(&error) => {}
            Err(error) => return Err(error),
        }
        // A browser that is too slow leaves messages in the queue. Messages that find no room are counted. Its requests
        // are still read.
        loop {
            if is_sent {
                let Ok(message) = waiting.try_recv() else {
                    break;
                };
                // A message that cannot be written yet waits in the socket.
                done(socket.write(message))?;
            }
            is_sent = done(socket.flush())?;
            if !is_sent {
                break;
            }
        }
    }
}

/// Returns true if everything was sent, and false if the rest has to wait for another turn.
fn done(sent: Result<(), Error>) -> Result<bool, Error> {
    match sent {
        Ok(()) => Ok(true),
        Err(error) if is_turn_over(&error) => Ok(false),
        Err(error) => Err(error),
    }
}

fn is_turn_over(error: &Error) -> bool {
    matches!(error, Error::Io(e) if matches!(e.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut))
}
