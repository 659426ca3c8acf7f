// SPDX-License-Identifier: LGPL-2.1-or-later
"use strict";

const one = (selector) => document.querySelector(selector);

// --- light and dark: that of the system until the reader chooses

const themeButton = one(".theme");
const systemDark = matchMedia("(prefers-color-scheme: dark)");

function stored(value) {
  // A browser may refuse storage to files.
  try {
    if (value !== undefined) localStorage.setItem("tombolo-theme", value);
    return localStorage.getItem("tombolo-theme");
  } catch { return null; }
}

function isDark() {
  const chosen = document.documentElement.dataset.theme;
  return chosen ? chosen === "dark" : systemDark.matches;
}

function nameTheme() { themeButton.textContent = isDark() ? "Light" : "Dark"; }

if (["light", "dark"].includes(stored())) document.documentElement.dataset.theme = stored();
themeButton.addEventListener("click", () => {
  document.documentElement.dataset.theme = stored(isDark() ? "light" : "dark") || (isDark() ? "light" : "dark");
  nameTheme();
});
systemDark.addEventListener("change", nameTheme);
nameTheme();

// --- pages on a phone

const menu = one(".menu"), pages = one("#site-pages");
menu.addEventListener("click", () => menu.setAttribute("aria-expanded", pages.classList.toggle("open")));

// Shows where the reader is in a list that is longer than the window.
const current = one("#site-pages [aria-current]");
if (current && current.offsetTop > pages.clientHeight) pages.scrollTop = current.offsetTop - pages.clientHeight / 2;

// --- search

const field = one(".search input"), results = one("#site-results");
const most = 25;
let loading = null, prepared = null, chosen = -1;

// The index is loaded when it is needed first.
function load() {
  loading ||= new Promise((done, failed) => {
    const script = document.createElement("script");
    script.src = "search-index.js";
    script.onload = () => {
      prepared = ranking.prepare(window.searchIndex);
      done();
    };
    script.onerror = () => failed(new Error("The index of the search is missing."));
    document.head.append(script);
  });
  return loading;
}

// The text with the words marked, as nodes: nothing of it is read as HTML.
function marked(text, words) {
  const nodes = [], lower = ranking.plain(text);
  let from = 0;
  while (from < text.length) {
    let at = -1, length = 0;
    for (const word of words) {
      const found = lower.indexOf(word, from);
      if (found >= 0 && (at < 0 || found < at)) { at = found; length = word.length; }
    }
    if (at < 0) break;
    const mark = document.createElement("mark");
    mark.textContent = text.slice(at, at + length);
    nodes.push(text.slice(from, at), mark);
    from = at + length;
  }
  return [...nodes, text.slice(from)];
}

function piece(section, words) {
  const places = words.map((word) => section.text.indexOf(word)).filter((place) => place >= 0);
  const begin = Math.max(0, (places.length ? Math.min(...places) : 0) - 50);
  return (begin ? "… " : "") + section.t.slice(begin, begin + 190) + (section.t.length > begin + 190 ? " …" : "");
}

function show(items) {
  results.replaceChildren(...items);
  results.hidden = items.length === 0;
  chosen = -1;
}

function line(section, words) {
  const item = document.createElement("li"), link = document.createElement("a"), head = document.createElement("b"),
    page = document.createElement("small"), text = document.createElement("span");
  link.href = section.u;
  head.append(...marked(section.h, words));
  page.textContent = section.p === section.h ? "" : section.p;
  text.append(...marked(piece(section, words), words));
  link.append(head, page, text);
  item.append(link);
  return item;
}

function note(words) {
  const item = document.createElement("li");
  item.className = "none";
  item.textContent = words;
  return item;
}

async function search() {
  if (!field.value.trim()) { show([]); return; }
  try { await load(); } catch (error) { show([note(error.message)]); return; }
  const { words, sections } = ranking.find(prepared, field.value);
  show(sections.length ? sections.slice(0, most).map((section) => line(section, words)) : [note("Nothing has all these words.")]);
}

function choose(step) {
  const links = [...results.querySelectorAll("a")];
  if (!links.length) return;
  chosen = (chosen + step + links.length) % links.length;
  links.forEach((link, k) => link.classList.toggle("now", k === chosen));
  links[chosen].scrollIntoView({ block: "nearest" });
}

field.addEventListener("focus", () => { load().catch(() => {}); if (field.value) search(); });
field.addEventListener("input", search);
field.addEventListener("keydown", (event) => {
  if (event.key === "ArrowDown" || event.key === "ArrowUp") {
    choose(event.key === "ArrowDown" ? 1 : -1);
    event.preventDefault();
  } else if (event.key === "Enter") {
    const links = results.querySelectorAll("a");
    if (links.length) links[Math.max(0, chosen)].click();
  } else if (event.key === "Escape") {
    show([]);
    field.blur();
  }
});
results.addEventListener("click", (event) => { if (event.target.closest("a")) show([]); });
document.addEventListener("click", (event) => { if (!event.target.closest(".search")) show([]); });
document.addEventListener("keydown", (event) => {
  if (event.key === "/" && !event.ctrlKey && !event.metaKey && !event.target.closest("input, textarea")) {
    field.focus();
    event.preventDefault();
  }
});
