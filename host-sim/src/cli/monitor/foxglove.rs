//! What comes from a source, over a WebSocket, in the protocol of Foxglove: Foxglove and PlotJuggler show it live.
//!
//! Four messages of it are spoken: `serverInfo` and `advertise` when somebody connects, `subscribe` and `unsubscribe`
//! from them, and for every sample that they want a binary message (1, subscription, time in ns, JSON). Topics and
//! fields are those of `estimate.mcap`.

use std::collections::HashMap;
use std::error::Error;
use std::io;
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::Duration;

use estimator_core::board::frame::Frame;
use serde_json::{Map, Value, json};
use tungstenite::handshake::server::{ErrorResponse, Request, Response};
use tungstenite::http::HeaderValue;
use tungstenite::{Message, WebSocket};

use super::source::Source;
use super::view::phase;
use crate::diagnostic::Diagnostic;
use crate::kind::Kind;
use crate::link::device::Statistics;
use crate::log::Channel;
use crate::output::say;

/// What clients ask for: the present name of the protocol, and the one before it.
const PROTOCOLS: [&str; 2] = ["foxglove.sdk.v1", "foxglove.websocket.v1"];
/// How long a client is listened to before what waits for it is sent.
const WAIT: Duration = Duration::from_millis(10);
/// The first byte of a binary message with data.
const DATA: u8 = 1;

/// A channel: its number and its topic.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum Topic {
    Sample = 1,
    Estimate = 2,
}

impl Topic {
    const ALL: [Topic; 2] = [Topic::Sample, Topic::Estimate];

    fn advertised(self, kind: Kind) -> Value {
        let channels = Channel::ALL.map(|channel| channel.column_of(kind));
        let (topic, name, numbers): (_, _, &[&str]) = match self {
            Topic::Sample => ("/palpate/sample", "palpate.Sample", &channels),
            Topic::Estimate => (
                "/palpate/estimate",
                "palpate.Estimate",
                &["t_s", "depth_m", "speed_mps", "force_n", "prediction_n"],
            ),
        };
        let mut properties: Map<String, Value> = numbers
            .iter()
            .map(|number| (number.to_string(), json!({ "type": "number" })))
            .collect();
        if self == Topic::Estimate {
            for word in ["phase", "status"] {
                properties.insert(word.into(), json!({ "type": "string" }));
            }
        }
        let schema = json!({ "type": "object", "title": name, "properties": properties });
        json!({
            "id": self as u32, "topic": topic, "encoding": "json", "schemaName": name,
            "schemaEncoding": "jsonschema", "schema": schema.to_string(),
        })
    }
}

/// A message for everybody who has subscribed to its topic.
#[derive(Clone)]
struct News {
    topic: Topic,
    time_ns: u64,
    json: String,
}

/// The clients that listen.
type Listeners = Arc<Mutex<Vec<Sender<News>>>>;

/// A source whose frames are served to whoever connects.
pub(super) struct Served {
    source: Box<dyn Source>,
    listeners: Listeners,
}

impl Served {
    /// Listens at an address, such as `127.0.0.1:8765`.
    ///
    /// # Errors
    /// An address that cannot be listened at.
    pub(super) fn new(source: Box<dyn Source>, address: &str) -> Result<Served, Box<dyn Error>> {
        let listener = TcpListener::bind(address).map_err(|error| {
            Diagnostic::new(format!("cannot listen there: {error}"))
                .value(address)
                .remedy("give a free address, such as --foxglove 127.0.0.1:8766")
        })?;
        say(format!(
            "Foxglove: open a connection to ws://{}\n",
            listener.local_addr()?
        ))?;
        let listeners = Listeners::default();
        let (name, kind) = (source.name().to_string(), source.kind());
        let all = Arc::clone(&listeners);
        thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                let (sender, receiver) = channel();
                if let Ok(mut all) = all.lock() {
                    all.push(sender);
                }
                let name = name.clone();
                // A client that goes away ends its thread, and with the next message its place in the list.
                thread::spawn(move || serve(stream, &name, kind, &receiver));
            }
        });
        Ok(Served { source, listeners })
    }

    fn tell(&self, frame: &Frame) {
        let Some(news) = news(frame, self.source.kind()) else {
            return;
        };
        if let Ok(mut all) = self.listeners.lock() {
            all.retain(|listener| listener.send(news.clone()).is_ok());
        }
    }
}

fn news(frame: &Frame, kind: Kind) -> Option<News> {
    let (topic, time_us, json) = match frame {
        Frame::Sample(sample) => {
            let [time, position, force] = Channel::ALL.map(|channel| channel.column_of(kind));
            let json = json!({
                time: sample.time_us as f64 * 1e-6, position: sample.position_m, force: sample.force_n,
            });
            (Topic::Sample, sample.time_us, json)
        }
        Frame::Estimate(estimate) => {
            let mut json = json!({
                "t_s": estimate.time_us as f64 * 1e-6, "depth_m": estimate.depth_m,
                "speed_mps": estimate.speed_mps, "force_n": estimate.force_n,
                "prediction_n": estimate.innovation.prediction_n,
                "phase": phase(estimate.phase).trim_end(), "status": estimate.status.name(),
            });
            for (info, slot) in estimate.law.parameters().iter().zip(estimate.parameters) {
                json[info.name] = json!(slot.map(|own| own.value));
                json[format!("{}_std_error", info.name)] = json!(slot.map(|own| own.std_error));
            }
            (Topic::Estimate, estimate.time_us, json)
        }
        _ => return None,
    };
    Some(News {
        topic,
        time_ns: time_us * 1000,
        json: json.to_string(),
    })
}

/// Speaks with one client until it goes away.
fn serve(stream: TcpStream, name: &str, kind: Kind, news: &Receiver<News>) {
    // Whatever goes wrong with one client is the end of that client.
    let _ = stream.set_nodelay(true);
    let Ok(mut socket) = tungstenite::accept_hdr(stream, agreed) else {
        return;
    };
    let _ = socket.get_mut().set_read_timeout(Some(WAIT));
    let _ = converse(&mut socket, name, kind, news);
}

/// Takes the protocol that the client offers and we speak.
#[allow(clippy::result_large_err)]
fn agreed(request: &Request, mut response: Response) -> Result<Response, ErrorResponse> {
    const HEADER: &str = "Sec-WebSocket-Protocol";
    let offered = request.headers().get_all(HEADER).iter();
    let offered: Vec<&str> = offered
        .filter_map(|value| value.to_str().ok())
        .flat_map(|value| value.split(',').map(str::trim))
        .collect();
    match PROTOCOLS.into_iter().find(|own| offered.contains(own)) {
        Some(own) => {
            response
                .headers_mut()
                .insert(HEADER, HeaderValue::from_static(own));
            Ok(response)
        }
        None => {
            let mut refused =
                ErrorResponse::new(Some(format!("speak one of {}", PROTOCOLS.join(", "))));
            *refused.status_mut() = tungstenite::http::StatusCode::BAD_REQUEST;
            Err(refused)
        }
    }
}

fn converse(
    socket: &mut WebSocket<TcpStream>,
    name: &str,
    kind: Kind,
    news: &Receiver<News>,
) -> tungstenite::Result<()> {
    let channels = Topic::ALL.map(|topic| topic.advertised(kind));
    let info = json!({
        "op": "serverInfo", "name": format!("palpate: {name}"), "capabilities": [], "supportedEncodings": ["json"],
    });
    let advertise = json!({ "op": "advertise", "channels": channels });
    for hello in [info, advertise] {
        socket.send(Message::text(hello.to_string()))?;
    }
    let mut subscribed: HashMap<u32, u32> = HashMap::new();
    loop {
        match socket.read() {
            Ok(Message::Text(text)) => hear(text.as_str(), &mut subscribed),
            Ok(Message::Close(_)) => return Ok(()),
            Ok(_) => {}
            Err(tungstenite::Error::Io(error)) if is_nothing(&error) => {}
            Err(error) => return Err(error),
        }
        loop {
            match news.try_recv() {
                Ok(one) => put(socket, &one, &subscribed)?,
                Err(TryRecvError::Empty) => break,
                Err(TryRecvError::Disconnected) => return socket.close(None),
            }
        }
        socket.flush()?;
    }
}

fn is_nothing(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut
    )
}

/// What a client asks for: subscriptions by their number, each to a channel.
fn hear(text: &str, subscribed: &mut HashMap<u32, u32>) {
    let Ok(said) = serde_json::from_str::<Value>(text) else {
        return;
    };
    let number = |value: &Value| value.as_u64().and_then(|number| u32::try_from(number).ok());
    match said["op"].as_str() {
        Some("subscribe") => {
            let wanted = said["subscriptions"].as_array().into_iter().flatten();
            let wanted =
                wanted.filter_map(|one| Some((number(&one["id"])?, number(&one["channelId"])?)));
            subscribed.extend(wanted);
        }
        Some("unsubscribe") => {
            let ids = said["subscriptionIds"].as_array().into_iter().flatten();
            for id in ids.filter_map(number) {
                subscribed.remove(&id);
            }
        }
        _ => {}
    }
}

fn put(
    socket: &mut WebSocket<TcpStream>,
    news: &News,
    subscribed: &HashMap<u32, u32>,
) -> tungstenite::Result<()> {
    let own = subscribed
        .iter()
        .filter(|(_, channel)| **channel == news.topic as u32);
    for (subscription, _) in own {
        let mut bytes = vec![DATA];
        bytes.extend(subscription.to_le_bytes());
        bytes.extend(news.time_ns.to_le_bytes());
        bytes.extend(news.json.as_bytes());
        socket.write(Message::binary(bytes))?;
    }
    Ok(())
}

impl Source for Served {
    fn name(&self) -> &str {
        self.source.name()
    }

    fn kind(&self) -> Kind {
        self.source.kind()
    }

    fn next_frame(&mut self) -> io::Result<Option<Frame>> {
        let frame = self.source.next_frame()?;
        if let Some(frame) = &frame {
            self.tell(frame);
        }
        Ok(frame)
    }

    fn has_ended(&self) -> bool {
        self.source.has_ended()
    }

    fn statistics(&self) -> Statistics {
        self.source.statistics()
    }

    fn begin_recording(&mut self, folder: &Path) -> Result<Option<String>, Box<dyn Error>> {
        self.source.begin_recording(folder)
    }

    fn end_recording(&mut self) -> Result<String, Box<dyn Error>> {
        self.source.end_recording()
    }
}
