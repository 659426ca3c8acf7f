// SPDX-License-Identifier: LGPL-2.1-or-later
"use strict";

// The ranking of the search, apart from the page that shows it: tests/pages/search_test.py runs it as well.
const ranking = (() => {
  // What counts a section that has the words: pages before tables, tables before classes.
  const weights = { page: 1, entries: 0.8, table: 0.35, changes: 0.3, class: 0.2 };
  const empty = new Set("a an and are at by do does for from how i in is it my of on or the to want what with".split(" "));
  const isLetter = (letter) => letter !== undefined && /[\p{L}\p{N}]/u.test(letter);

  // Lower case, with blanks in place of hyphens, underscores, slashes and quotes. As long as the text, so that places agree.
  function plain(text) { return text.toLowerCase().replace(/[-‐‑–_/`"']/g, " "); }

  // "curves" finds what begins with "curve".
  function stem(word) { return word.length > 4 && word.endsWith("s") && !word.endsWith("ss") ? word.slice(0, -1) : word; }

  function allWordsOf(query) { return plain(query).split(/[\s,.;:*]+/).filter(Boolean).map(stem); }

  // Without those that mean little, unless there are no others.
  function meaning(words) {
    const left = words.filter((word) => !empty.has(word));
    return left.length ? left : words;
  }

  function termOf(words) { return { words: meaning(words), phrase: words.join(" ") }; }

  function prepare(index) {
    const synonyms = new Map();
    for (const [term, others] of Object.entries(index.synonyms))
      synonyms.set(allWordsOf(term).join(" "), others.map((other) => termOf(allWordsOf(other))));
    return { synonyms, sections: index.sections.map((section) =>
      ({ ...section, head: plain(section.h), page: plain(section.p), text: plain(section.t) })) };
  }

  // How often a word begins so in a text, up to eight times; words of up to three letters must be whole.
  function count(text, word) {
    let n = 0;
    for (let at = text.indexOf(word); at >= 0 && n < 8; at = text.indexOf(word, at + word.length))
      if (!isLetter(text[at - 1]) && (word.length > 3 || !isLetter(text[at + word.length]))) ++n;
    return n;
  }

  // The terms of a query: the longest ones that have synonyms, single words else; each with its synonyms.
  function termsOf(words, synonyms) {
    const terms = [];
    for (let from = 0; from < words.length;) {
      let to = Math.min(words.length, from + 4);
      while (to > from + 1 && !synonyms.has(words.slice(from, to).join(" "))) --to;
      const own = words.slice(from, to), others = synonyms.get(own.join(" "));
      if (others || !empty.has(own[0]) || words.length === 1) terms.push([termOf(own), ...(others || [])]);
      from = to;
    }
    return terms;
  }

  function scoreOfTitle(title, word) {
    if (!count(title, word)) return 0;
    return stem(title) === word ? 60 : title.startsWith(word) ? 30 : 18;
  }

  // How well a section answers to one term; zero unless it has all of its words.
  function scoreOfTerm(section, { words, phrase }) {
    let sum = 0;
    for (const word of words) {
      const own = scoreOfTitle(section.head, word) + scoreOfTitle(section.page, word) / 3 + count(section.text, word);
      if (!own) return 0;
      sum += own;
    }
    if (words.length === 1) return sum;
    const bonus = stem(section.head) === phrase ? 50 : count(section.head, phrase) ? 30 : count(section.text, phrase) ? 12 : 0;
    return (sum / words.length) * (bonus ? 1 : 0.5) + bonus;
  }

  function score(section, terms) {
    let sum = 0;
    for (const choices of terms) {
      // A synonym counts almost as the word itself, those that stand first more than later ones.
      const best = Math.max(...choices.map((term, k) => scoreOfTerm(section, term) * (1 - 0.1 * k)));
      if (best <= 0) return 0;
      sum += best;
    }
    return sum * weights[section.k];
  }

  // Sections of a prepared index that have all terms of a query, the best first, and the words to mark in them.
  function find(prepared, query) {
    const words = allWordsOf(query), terms = termsOf(words, prepared.synonyms), phrase = words.join(" ");
    if (!terms.length) return { words: [], sections: [] };
    const scored = [];
    for (const section of prepared.sections) {
      let points = score(section, terms);
      if (points > 0 && terms.length > 1 && (count(section.head, phrase) || count(section.text, phrase)))
        points += 15 * weights[section.k];
      if (points > 0) scored.push([points, section]);
    }
    scored.sort((a, b) => b[0] - a[0]);
    return { words: [...new Set(terms.flat().flatMap((term) => term.words))], sections: scored.map(([, section]) => section) };
  }

  return { find, plain, prepare };
})();

if (typeof module !== "undefined") module.exports = ranking;
