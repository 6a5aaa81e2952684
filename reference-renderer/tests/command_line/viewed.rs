//! `srbf view` beside clients that take all they can get.

use crate::PROGRAM;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

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
