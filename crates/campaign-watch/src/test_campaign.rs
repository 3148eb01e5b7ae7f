//! A campaign of a closed form for the tests, with a server of its folder.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use campaign::run_store::{Observation, Store};
use campaign::{
    Campaign, CampaignPlan, MeasuredMean, ParameterName, ProgressFolder, RunOutcome, RunRequest,
    Silent, Simulator, SimulatorError, StagePlan,
};
use serde_json::json;
use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;

use crate::{CampaignFolder, Server};

/// A picture of one pixel.
const PIXEL: &str =
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGNgYGAAAAAEAAH2FzhVAAAAAElFTkSuQmCC";

/// A name with markup, which must stand in the page as it is.
pub(crate) const ODD_MODEL: &str = "drum <img src=x onerror=alert(1)> & \"15 rpm\"";

/// An angle that grows with the friction; fails where that is negative.
pub(crate) struct Slope;

impl Simulator for Slope {
    fn version(&self) -> String {
        "slope 1".into()
    }

    fn run(&self, request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
        let friction = request.parameter("F")?;
        if friction < 0.0 {
            let reason = "below 0".to_owned();
            return Err(SimulatorError::Failed { reason });
        }
        let angle = Observation {
            mean: 20.0 + 40.0 * friction,
            sd: Some(0.5),
            n: 10,
            unit: "deg".into(),
        };
        Ok(RunOutcome {
            details: json!({"last_frame_png_base64": PIXEL}),
            regime: Some("rolling".into()),
            ..RunOutcome::default().with_observable("angle_deg", angle)
        })
    }
}

/// The picture of every run.
pub(crate) fn pixel() -> Vec<u8> {
    STANDARD.decode(PIXEL).unwrap()
}

/// What the campaign is.
pub(crate) fn plan() -> CampaignPlan {
    let stage = |name: &str, runs| StagePlan {
        name: name.into(),
        runs,
        at_most_further: 7,
    };
    let friction = ParameterName {
        name: "static friction <b>".into(),
        unit: "1".into(),
    };
    CampaignPlan {
        name: "beans </title><script>alert(1)</script>".into(),
        stages: vec![stage("before", 1), stage("surfaces & estimate", 4)],
        parameters: [("F".to_owned(), friction)].into(),
        measured: vec![MeasuredMean {
            model: ODD_MODEL.into(),
            observable: "angle_deg".into(),
            mean: 33.25,
            role: "fit".into(),
        }],
    }
}

/// Requests at these frictions.
pub(crate) fn requests(frictions: &[f64]) -> Vec<RunRequest> {
    let request = |friction: &f64| RunRequest::new(ODD_MODEL, 7).with_parameter("F", *friction);
    frictions.iter().map(request).collect()
}

/// Runs a list in a folder, and leaves the campaign as one that goes on.
pub(crate) fn run(folder: &Path, frictions: &[f64]) {
    let store = Store::open(folder.join("runs")).unwrap();
    let progress = ProgressFolder::new(folder, plan(), &Silent);
    progress.announce("surfaces & estimate");
    let campaign = Campaign::new(&store, 1, &progress);
    campaign.run_each(&Slope, &requests(frictions)).unwrap();
    // One that is in the middle of it tells no end.
    std::mem::forget(progress);
}

/// A server in a thread.
pub(crate) struct Served {
    /// Its address.
    pub(crate) address: String,
    /// Ends it.
    stop: Arc<AtomicBool>,
    /// Its thread.
    thread: Option<JoinHandle<()>>,
}

impl Drop for Served {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::SeqCst);
        self.thread.take().map(JoinHandle::join);
    }
}

impl Served {
    /// Serves a folder.
    pub(crate) fn of(folder: &Path) -> Self {
        Self::with(Server::bind(CampaignFolder::open(folder).unwrap(), 0).unwrap())
    }

    /// Serves.
    pub(crate) fn with(server: Server) -> Self {
        let stop = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&stop);
        let address = server.address();
        let thread = Some(std::thread::spawn(move || server.serve(&flag)));
        Self {
            address,
            stop,
            thread,
        }
    }

    /// Host and port.
    pub(crate) fn host(&self) -> &str {
        self.address.split('/').nth(2).unwrap()
    }

    /// The path with the token.
    pub(crate) fn path(&self) -> String {
        format!("/{}/", self.address.split('/').nth(3).unwrap())
    }

    /// A connection.
    pub(crate) fn connect(&self) -> TcpStream {
        TcpStream::connect(self.host()).unwrap()
    }

    /// What comes back on these bytes.
    pub(crate) fn send(&self, bytes: &[u8]) -> Vec<u8> {
        let mut stream = self.connect();
        // A server that has seen enough may close while this is still being written.
        let _ = stream.write_all(bytes);
        let mut reply = Vec::new();
        let _ = stream.read_to_end(&mut reply);
        reply
    }

    /// What comes back on a request of a browser.
    pub(crate) fn get(&self, target: &str) -> (u16, String) {
        let request = format!(
            "GET {target} HTTP/1.1\r\nHost: {}\r\nAccept: */*\r\n\r\n",
            self.host()
        );
        told(&self.send(request.as_bytes()))
    }

    /// The part of the page of a name.
    pub(crate) fn part(&self, name: &str) -> String {
        let (status, body) = self.get(&format!("{}data.json", self.path()));
        assert_eq!(status, 200);
        let body = body.split_once("\r\n\r\n").unwrap().1;
        let data: serde_json::Value = serde_json::from_str(body).unwrap();
        data["parts"][name].as_str().unwrap().to_owned()
    }
}

/// The number of the status and the whole reply.
pub(crate) fn told(reply: &[u8]) -> (u16, String) {
    let text = String::from_utf8_lossy(reply).into_owned();
    let number = text
        .strip_prefix("HTTP/1.1 ")
        .and_then(|rest| rest.get(..3));
    (number.unwrap_or("0").parse().unwrap(), text)
}
