// Unpacks the page's own code and starts it.
(async () => {
  try {
    const text = document.getElementById("code").textContent.trim();
    const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
    const script = document.createElement("script");
    script.textContent = await new Response(stream).text();
    document.head.append(script);
  } catch (error) {
    document.body.textContent = `This page needs a browser of 2023 or later: ${error}`;
    document.body.dataset.error = String(error);
  }
})();
