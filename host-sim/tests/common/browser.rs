//! Reports in a headless browser: each is opened at several widths, pointed at and zoomed, and what it did is
//! read back.
//!
//! One page holds every report in a frame of its own, so that one browser is started. A copy of each report carries a
//! few lines before everything else that write down script errors and what the page tried to fetch.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

/// Widths at which reports are opened (px): a telephone, a small window, a screen.
pub(crate) const WIDTHS: [u32; 3] = [400, 800, 1400];

const LISTEN: &str = "<script>window.noticed={errors:[],refused:[]};\
    addEventListener('error',e=>noticed.errors.push(e.message+' at line '+e.lineno));\
    addEventListener('unhandledrejection',e=>noticed.errors.push(String(e.reason)));\
    addEventListener('securitypolicyviolation',e=>noticed.refused.push(e.blockedURI));</script>";

/// What a frame says of its report once everything is loaded.
const LOOK: &str = r#"
function looked(frame) {
  const own = frame.contentWindow, doc = frame.contentDocument, root = doc.documentElement;
  const charts = [...doc.querySelectorAll('svg.chart[data-x]')];
  let tips = 0, zoomed = 0, whole = 0;
  for (const chart of charts) {
    chart.scrollIntoView();
    const box = chart.getBoundingClientRect();
    const at = (x, y, type, more) => chart.dispatchEvent(new own.PointerEvent(type, Object.assign({
      bubbles: true, clientX: box.left + x * box.width, clientY: box.top + y * box.height, pointerType: 'mouse',
    }, more)));
    at(0.6, 0.5, 'pointermove');
    const tip = doc.querySelector('.tip');
    tips += tip && !tip.hidden && tip.textContent.length > 4 ? 1 : 0;
    at(0.5, 0.5, 'pointerdown', {button: 0});
    at(0.7, 0.5, 'pointermove');
    at(0.7, 0.5, 'pointerup', {button: 0});
    zoomed += chart.classList.contains('zoomed') && chart.querySelectorAll('g.own text').length > 1 ? 1 : 0;
    chart.dispatchEvent(new own.MouseEvent('dblclick', {bubbles: true}));
    whole += chart.classList.contains('zoomed') ? 0 : 1;
  }
  const scrolls = [...doc.querySelectorAll('.scroll')];
  const beyond = scrolls.filter(s => s.scrollWidth > s.clientWidth + 2);
  const captions = [...doc.querySelectorAll('figure')].filter(f => {
    const said = f.querySelector('figcaption');
    return !said || said.textContent.replace(/^Figure \d+\./, '').trim().length < 5;
  });
  const tables = scrolls.filter(s => s.querySelector('tbody td'));
  const right = s => s.getBoundingClientRect().right;
  const unseen = tables.filter(s => s.querySelector('tbody td').getBoundingClientRect().left > right(s) - 40);
  const cut = tables.filter(s => {
    const said = s.querySelector('caption span');
    return said && said.getBoundingClientRect().right > right(s) + 2;
  });
  const tall = tables.flatMap(s => [...s.querySelectorAll('tbody tr')]).filter(r => r.getBoundingClientRect().height > 150);
  const named = e => e.textContent.slice(0, 60);
  const timing = own.performance.getEntriesByType('navigation')[0];
  return {
    report: frame.dataset.report, width: Number(frame.width), errors: own.noticed.errors, refused: own.noticed.refused,
    requests: own.performance.getEntriesByType('resource').map(r => r.name),
    scroll_width: root.scrollWidth, title: doc.title, headings: doc.querySelectorAll('h2').length,
    contents: !!doc.querySelector('nav.contents'), charts: charts.length, tips, zoomed, whole,
    cued: beyond.every(s => s.classList.contains('more') && s.nextElementSibling.className === 'cue'
      && !s.nextElementSibling.hidden),
    unseen: unseen.map(named), cut: cut.map(named), tall: tall.map(named),
    uncaptioned: captions.map(f => f.querySelector('h3').textContent),
    load_ms: timing ? timing.loadEventEnd : null,
  };
}
addEventListener('load', () => {
  const said = document.createElement('pre');
  said.id = 'looked';
  try {
    said.textContent = JSON.stringify([...document.querySelectorAll('iframe')].map(looked));
  } catch (error) { said.textContent = JSON.stringify({error: String(error)}); }
  document.body.replaceChildren(said);
});
"#;

/// The browser that `cargo xtask test` has set up.
fn browser() -> PathBuf {
    let given = std::env::var_os("PALPATE_BROWSER");
    given.map_or_else(|| PathBuf::from("chromium"), PathBuf::from)
}

/// Opens the reports at every width in `folder`, which keeps the copies, and gives what each frame says.
pub(crate) fn opened(folder: &Path, reports: &[(&str, PathBuf)], widths: &[u32]) -> Vec<Value> {
    let mut frames = String::new();
    for (name, path) in reports {
        let html = std::fs::read_to_string(path).unwrap();
        let copy = html.replacen("<head>", &format!("<head>{LISTEN}"), 1);
        assert!(copy.len() > html.len(), "{name} has no head");
        std::fs::write(folder.join(format!("{name}.html")), copy).unwrap();
        for width in widths {
            frames += &format!(
                "<iframe src=\"{name}.html\" data-report=\"{name}\" width=\"{width}\" height=\"900\"></iframe>\n"
            );
        }
    }
    let page = folder.join("looking.html");
    let html = format!(
        "<!DOCTYPE html><meta charset=\"utf-8\"><script>{LOOK}</script><body>{frames}</body>"
    );
    std::fs::write(&page, html).unwrap();
    let text = dumped(folder, &page);
    let (_, after) = text
        .split_once("<pre id=\"looked\">")
        .unwrap_or_else(|| panic!("{text}"));
    let json = after.split("</pre>").next().unwrap();
    let json = json
        .replace("&lt;", "<")
        .replace("&gt;", ">")
        .replace("&nbsp;", "\u{a0}");
    let looked: Value = serde_json::from_str(&json.replace("&amp;", "&")).unwrap();
    assert!(looked["error"].is_null(), "{looked}");
    looked.as_array().unwrap().clone()
}

/// What the page is once it is loaded.
fn dumped(folder: &Path, page: &Path) -> String {
    let mut command = Command::new(browser());
    // Frames of files may look into each other; nothing is fetched, and no profile of anybody is touched.
    command.args([
        "--headless",
        "--no-sandbox",
        "--disable-gpu",
        "--disable-dev-shm-usage",
        "--allow-file-access-from-files",
        "--no-first-run",
        "--disable-extensions",
        "--disable-background-networking",
        "--timeout=60000",
        "--dump-dom",
    ]);
    command.arg(format!(
        "--user-data-dir={}",
        folder.join("profile").display()
    ));
    command.arg(format!("file://{}", page.display()));
    let done = command.output().unwrap_or_else(|error| {
        panic!(
            "{}: {error}; `cargo xtask test` sets the browser up",
            browser().display()
        )
    });
    String::from_utf8_lossy(&done.stdout).into_owned()
}

/// Every report is silent, fetches nothing, fits its width, and answers the pointer.
pub(crate) fn assert_good(looked: &[Value]) {
    for frame in looked {
        let none = |key: &str| {
            assert_eq!(
                frame[key].as_array().map(Vec::len),
                Some(0),
                "{key}: {frame}"
            )
        };
        none("errors");
        none("refused");
        none("requests");
        none("uncaptioned");
        // Of a table the first value and the whole caption are seen, and no row is a column of words.
        none("unseen");
        none("cut");
        none("tall");
        assert!(
            frame["scroll_width"].as_u64() <= frame["width"].as_u64(),
            "overflows: {frame}"
        );
        assert_eq!(
            frame["cued"], true,
            "something scrolls without a cue: {frame}"
        );
        let charts = frame["charts"].as_u64().unwrap();
        assert!(charts > 0, "{frame}");
        for key in ["zoomed", "whole", "tips"] {
            assert_eq!(frame[key].as_u64(), Some(charts), "{key}: {frame}");
        }
        let is_long = frame["headings"].as_u64() > Some(4);
        assert!(
            frame["contents"] == true || !is_long,
            "no contents: {frame}"
        );
        let title = frame["title"].as_str().unwrap();
        assert!(!title.is_empty() && !title.contains("/tmp"), "{title}");
    }
}
