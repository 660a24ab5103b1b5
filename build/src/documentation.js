
// The robot in 3-D takes the place of its picture where the browser can show it.
if (document.createElement("canvas").getContext("webgl2")) {
  const frame = document.createElement("iframe");
  frame.src = "robot.html";
  frame.title = "The robot in 3-D: drag to turn, + and - to zoom";
  const whole = document.createElement("a");
  whole.href = "robot.html";
  whole.textContent = "The robot in the whole window";
  document.getElementById("robot").replaceChildren(frame, whole);
}
