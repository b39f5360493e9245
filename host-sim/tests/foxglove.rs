//! `palpate monitor --foxglove`: a client of the protocol sees a board live.

mod common;

use std::io::{BufRead, BufReader};
use std::process::{Child, Stdio};

use common::Folder;
use serde_json::{Value, json};
use tungstenite::client::IntoClientRequest;
use tungstenite::http::HeaderValue;
use tungstenite::{Message, connect};

/// A monitor that ends with its test.
struct Monitor(Child);

impl Drop for Monitor {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A monitor of the simulated board, and the address that it says it serves.
fn served(folder: &Folder) -> (Monitor, String) {
    let arguments = [
        "monitor",
        "--port",
        "simulated",
        "--every",
        "0.1",
        "--looks",
        "200",
        "--foxglove",
        "127.0.0.1:0",
    ];
    let mut child = folder
        .command(&arguments)
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    let said = lines.next().unwrap().unwrap();
    let address = said[said.find("ws://").unwrap()..].trim().to_string();
    // Somebody has to read what it says, or it waits.
    std::thread::spawn(move || lines.for_each(drop));
    (Monitor(child), address)
}

#[test]
fn a_client_is_told_of_both_topics_and_gets_what_it_subscribes_to() {
    let folder = Folder::new();
    let (_monitor, address) = served(&folder);
    for protocol in ["foxglove.sdk.v1", "foxglove.websocket.v1"] {
        let mut request = address.as_str().into_client_request().unwrap();
        let own = HeaderValue::from_static(protocol);
        request.headers_mut().insert("Sec-WebSocket-Protocol", own);
        let (mut socket, response) = connect(request).unwrap();
        assert_eq!(response.headers()["sec-websocket-protocol"], protocol);
        let mut hello = || -> Value {
            let Message::Text(text) = socket.read().unwrap() else {
                panic!("no text");
            };
            serde_json::from_str(text.as_str()).unwrap()
        };
        // GIVEN what the server says of itself
        assert_eq!(hello()["op"], "serverInfo");
        let advertised = hello();
        let channels = advertised["channels"].as_array().unwrap();
        let topics: Vec<&str> = channels
            .iter()
            .map(|one| one["topic"].as_str().unwrap())
            .collect();
        assert_eq!(topics, ["/palpate/sample", "/palpate/estimate"]);
        for channel in channels {
            let schema: Value = serde_json::from_str(channel["schema"].as_str().unwrap()).unwrap();
            assert_eq!(schema["properties"]["t_s"]["type"], "number");
        }
        // WHEN the estimates are subscribed to under a number of the client's own
        let wanted = json!({ "op": "subscribe", "subscriptions": [{ "id": 7, "channelId": channels[1]["id"] }] });
        socket.send(Message::text(wanted.to_string())).unwrap();
        // THEN they come, one a millisecond, with their time in front.
        let mut before_ns = 0;
        for number in 0..50 {
            let Message::Binary(bytes) = socket.read().unwrap() else {
                panic!("no data");
            };
            assert_eq!(bytes[0], 1);
            assert_eq!(bytes[1..5], 7_u32.to_le_bytes());
            let time_ns = u64::from_le_bytes(bytes[5..13].try_into().unwrap());
            let estimate: Value = serde_json::from_slice(&bytes[13..]).unwrap();
            assert!((estimate["t_s"].as_f64().unwrap() * 1e9 - time_ns as f64).abs() < 1e3);
            assert!(estimate["force_n"].is_number() && estimate["status"].is_string());
            // The first ones, of before the filter is full, have the time 0.
            let is_next = time_ns == before_ns + 1_000_000 || before_ns == 0;
            assert!(number == 0 || is_next, "{time_ns} after {before_ns}");
            before_ns = time_ns;
        }
    }
}

#[test]
fn a_client_of_another_protocol_is_refused() {
    let folder = Folder::new();
    let (_monitor, address) = served(&folder);
    let error = connect(address.as_str()).unwrap_err().to_string();
    assert!(error.contains("400"), "{error}");
}
