//! The mechanics of the rig: commands out, events in.

use std::io::{BufRead, BufReader, Write};
use std::os::unix::net::UnixStream;
use std::sync::mpsc::{Receiver, channel};

/// The connection to the mechanics.
pub struct PlantLink {
    stream: UnixStream,
    /// Events; a thread reads them, because the mechanics leave a reader that is slow.
    events: Receiver<serde_json::Value>,
}

impl PlantLink {
    /// Connects; the rig names its socket in the environment.
    pub fn connect() -> Self {
        let path = std::env::var("KT_ETHERCAT_PLANT").expect("KT_ETHERCAT_PLANT: run this on the rig");
        let stream = UnixStream::connect(path).expect("socket of the plant");
        let reader = BufReader::new(stream.try_clone().expect("socket of the plant"));
        let (sender, events) = channel();
        std::thread::spawn(move || {
            for line in reader.lines().map_while(Result::ok) {
                let event = serde_json::from_str(&line).expect("event of the plant");
                if sender.send(event).is_err() {
                    return;
                }
            }
        });
        Self { stream, events }
    }

    /// Sends a command; the control goes on meanwhile.
    pub fn send(&mut self, command: &str) {
        writeln!(self.stream, "{command}").expect("plant");
    }

    /// The events since the last call.
    pub fn events(&self) -> Vec<serde_json::Value> {
        self.events.try_iter().collect()
    }

    /// The outputs that went on or off since the last call: name and level, in their order.
    pub fn outputs(&self) -> Vec<(String, bool)> {
        let is_output = |event: &serde_json::Value| {
            let name = event["name"].as_str().filter(|_| event["event"] == "output")?;
            Some((name.to_owned(), event["value"] == 1))
        };
        self.events().iter().filter_map(is_output).collect()
    }

    /// The state of the machine now.
    pub fn status(&mut self) -> serde_json::Value {
        self.send("status");
        let mut events = self.events.iter();
        events.find(|event| event["event"] == "status").expect("status of the plant")
    }
}
