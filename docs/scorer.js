// Scores of the search: those of Sphinx, but how-to pages before theory, and both before functions.
const BEHIND = [
  [/^(api|auto_gallery|decisions)\//, 4],
  [/^(theory\/|architecture$|bibliography$|commands$)/, 1],
];
var Scorer = {
  score: ([docname, title, anchor, descr, score]) =>
    score - (BEHIND.find(([pages]) => pages.test(docname)) ?? [null, 0])[1],
  objNameMatch: 11,
  objPartialMatch: 4,
  objPrio: { 0: 3, 1: 1, 2: -5 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
};
