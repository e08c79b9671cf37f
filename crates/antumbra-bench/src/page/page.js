"use strict";
const $ = (selector, within = document) => within.querySelector(selector);
const $$ = (selector, within = document) => [...within.querySelectorAll(selector)];

$("[data-copy]").addEventListener("click", async event => {
  await navigator.clipboard?.writeText($(".command code").textContent);
  event.target.textContent = "Copied";
});
$("#scheme").addEventListener("click", () => {
  const dark = getComputedStyle(document.body).backgroundColor === "rgb(18, 19, 23)";
  document.documentElement.dataset.scheme = dark ? "light" : "dark";
});
