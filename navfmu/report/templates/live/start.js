// What is folded is printed, too, where it is not long.
const folded = [...document.querySelectorAll("details:not(.paper)")].filter((part) => part.textContent.length < 30000);
let opened = [];
window.addEventListener("beforeprint", () => {
  opened = folded.filter((part) => !part.open);
  for (const part of opened) part.open = true;
});
window.addEventListener("afterprint", () => {
  for (const part of opened) part.open = false;
});

routed();
