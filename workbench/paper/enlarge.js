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
