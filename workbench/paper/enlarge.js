// A picture fills the window when it is clicked or tapped; Escape or a second click closes it.
for (const button of document.querySelectorAll("button.enlarge")) {
  button.addEventListener("click", () => {
    const dialog = document.getElementById("enlarged"), picture = dialog.querySelector("img"), own = button.querySelector("img");
    picture.src = own.src;
    picture.alt = own.alt;
    dialog.showModal();
    dialog.scrollTo(0, 0);
  });
}
document.getElementById("enlarged").addEventListener("click", (event) => event.currentTarget.close());

// A link opens the folded section that it points at; on paper all are open.
const unfold = (section) => section?.querySelectorAll(":scope > details").forEach((details) => (details.open = true));
const pointed = () => unfold(location.hash.length > 1 ? document.querySelector(location.hash) : null);
window.addEventListener("hashchange", pointed);
document.addEventListener("click", ({ target }) => unfold(document.querySelector(target.closest?.('a[href^="#"]')?.getAttribute("href") || "#none")));
window.addEventListener("beforeprint", () => document.querySelectorAll("section").forEach(unfold));
pointed();
