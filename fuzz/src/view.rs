//! Requests of a stranger to the server of `srbf view`, whose text is compiled by its path: the program has many packages.

#[allow(dead_code)] // all but the reading of requests
#[path = "../../reference-renderer/src/command/view/server.rs"]
mod server;

/// A file is given to who names the server's own address, and questions are answered to its own page.
///
/// # Panics
/// If not.
pub fn run(bytes: &[u8]) {
    let files = vec![("index.html", b"page".to_vec()), ("page.js", b"script".to_vec())];
    let text = String::from_utf8_lossy(bytes).to_lowercase();
    let hosts = ["127.0.0.1:80", "localhost:80"];
    match server::asked(bytes, &files, 80) {
        Ok((question, end)) => {
            assert!(["open", "export"].contains(&question.verb.as_str()) && question.length <= 1 << 28);
            assert!(end <= bytes.len() && hosts.iter().any(|host| text.contains(&format!("http://{host}"))));
        }
        Err((status, _, body)) => {
            let is_file = files.iter().any(|file| file.1 == body);
            assert_eq!(status == "200 OK", is_file, "{status}");
            assert!(!is_file || hosts.iter().any(|host| text.contains(host)), "another host gets a file");
            assert!(status[..3].parse::<u16>().is_ok_and(|number| (200..=431).contains(&number)), "{status}");
        }
    }
}
