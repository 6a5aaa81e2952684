//! `srbf view` beside clients that take all they can get.

use crate::PROGRAM;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{Shutdown, TcpStream};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A server, which ends with this.
struct Server {
    child: Child,
    address: String,
}

impl Server {
    /// Starts one behind the commands of a shell.
    fn start(before: &str) -> Self {
        let call = format!("{before} exec \"$0\" view --no-open");
        let mut child =
            Command::new("sh").args(["-c", &call, PROGRAM]).stdout(Stdio::piped()).spawn().unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
        let address = line.strip_prefix("http://").and_then(|rest| rest.split('/').next());
        let address = address.unwrap_or_else(|| panic!("no address: {line}")).to_owned();
        Self { child, address }
    }

    fn connected(&self) -> TcpStream {
        let stream = TcpStream::connect(&self.address).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
        stream
    }

    /// Connections that say nothing.
    fn silent(&self, count: usize) -> Vec<TcpStream> {
        let silent = (0..count).map(|_| self.connected()).collect();
        std::thread::sleep(Duration::from_secs(1));
        silent
    }

    fn check_page(&self) {
        let mut stream = self.connected();
        write!(stream, "GET / HTTP/1.1\r\nHost: {}\r\n\r\n", self.address).unwrap();
        let mut text = String::new();
        stream.read_to_string(&mut text).unwrap();
        assert!(text.starts_with("HTTP/1.1 200 OK"), "{text}");
    }

    /// Sends a request; the status of its answer, 0 where the connection ends without one.
    fn status(&self, request: &[u8]) -> u16 {
        let mut stream = self.connected();
        let mut answer = Vec::new();
        // A request may be refused before all of it is sent.
        let _ = stream.write_all(request).and_then(|()| stream.shutdown(Shutdown::Write));
        let _ = stream.read_to_end(&mut answer);
        let text = String::from_utf8_lossy(&answer);
        text.split(' ').nth(1).map_or(0, |status| status.parse().unwrap())
    }

    /// Bytes that the process has in memory.
    fn memory(&self) -> usize {
        let text = std::fs::read_to_string(format!("/proc/{}/statm", self.child.id())).unwrap();
        4096 * text.split(' ').nth(1).unwrap().parse::<usize>().unwrap()
    }

    /// Entries of a folder of the process.
    fn count(&self, folder: &str) -> usize {
        std::fs::read_dir(format!("/proc/{}/{folder}", self.child.id())).unwrap().count()
    }

    /// Hundredths of a second of processors that it has taken.
    fn time(&self) -> u64 {
        let text = std::fs::read_to_string(format!("/proc/{}/stat", self.child.id())).unwrap();
        let fields: Vec<&str> = text.rsplit(')').next().unwrap().split_whitespace().collect();
        [11, 12].iter().map(|n| fields[*n].parse::<u64>().unwrap()).sum()
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
fn many_clients_take_no_more_threads_than_a_few() {
    let server = Server::start("");
    // The queue of the system holds the rest.
    let silent = server.silent(140);
    let (threads, files) = (server.count("task"), server.count("fd"));
    assert!(threads <= 40 && files <= 50, "{threads} threads, {files} files are open");
    drop(silent);
    server.check_page();
}

#[test]
fn where_no_more_files_can_be_opened_the_server_waits_and_goes_on() {
    let server = Server::start("ulimit -n 24;");
    let silent = server.silent(60);
    // Those of higher numbers are inherited.
    assert!(server.count("fd") >= 24, "not at the limit");
    let before = server.time();
    std::thread::sleep(Duration::from_secs(2));
    let taken = server.time() - before;
    assert!(taken <= 20, "{taken} hundredths of a second of a processor in 2 s");
    assert!(server.count("fd") >= 24, "not at the limit");
    drop(silent);
    server.check_page();
}

/// Requests of every kind, whole, cut and damaged, take no more memory and no more files the more there are. `SRBF_REQUESTS` is their number
/// in place of a few.
#[test]
fn requests_of_every_kind_leave_nothing_behind() {
    let server = Server::start("");
    let count: usize = std::env::var("SRBF_REQUESTS").map_or(600, |text| text.parse().unwrap());
    let preset = include_bytes!("../../../presets/cayman.srbf");
    let own = &server.address;
    let get = |path: &str| format!("GET {path} HTTP/1.1\r\nHost: {own}\r\n\r\n").into_bytes();
    let post = |path: &str, content: &[u8]| {
        let length = content.len();
        let head = format!(
            "POST {path} HTTP/1.1\r\nHost: {own}\r\nOrigin: http://{own}\r\nContent-Length: {length}\r\n\r\n"
        );
        [head.as_bytes(), content].concat()
    };
    let kinds = [
        (get("/"), 200),
        (get("/page.js"), 200),
        (get("/nothing"), 404),
        (b"GET / HTTP/1.1\r\nHost: example.org\r\n\r\n".to_vec(), 403),
        (b"PUT / HTTP/1.1\r\n\r\n".to_vec(), 405),
        ([&b"GET /"[..], &[b'a'; 8300]].concat(), 431),
        (post("/open?cayman.srbf", preset), 200),
        (post("/open?cut.srbf", &preset[..1000]), 200),
        (post("/export?glsl", preset), 200),
        (post("/export?nothing", b""), 200),
        (b"GET / HT".to_vec(), 0),
        (post("/open?less.srbf", preset)[..600].to_vec(), 0),
    ];
    let mut random = 1u64;
    let mut below = |n: usize| {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (random >> 33) as usize % n
    };
    let (mut before, start) = ((0, 0), Instant::now());
    for n in 0..count {
        let (request, status) = &kinds[n % kinds.len()];
        assert_eq!(
            server.status(request),
            *status,
            "{}",
            String::from_utf8_lossy(&request[..request.len().min(40)])
        );
        let mut damaged = request.clone();
        // The head, as the length would be another.
        (0..1 + below(4)).for_each(|_| damaged[below(request.len().min(80))] = below(256) as u8);
        let status = server.status(&damaged);
        assert!([0, 200, 403, 404, 405, 413, 431].contains(&status), "{status}: {damaged:?}");
        if n == count / 2 {
            before = (server.memory(), server.count("fd"));
        }
    }
    let after = (server.memory(), server.count("fd"));
    println!("{} requests in {:?}: {before:?}, then {after:?} bytes and files", 2 * count, start.elapsed());
    assert!(after.0 < before.0 + 4_000_000 && after.1 <= before.1 + 2, "{before:?}, then {after:?}");
    server.check_page();
}
