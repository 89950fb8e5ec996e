// Scores of the search: those of Sphinx, with pages before the reference of functions and the gallery.
var Scorer = {
  score: ([docname, title, anchor, descr, score]) =>
    /^(api|auto_gallery|decisions)\//.test(docname) ? score - 4 : score,
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: { 0: 15, 1: 5, 2: -5 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
};
