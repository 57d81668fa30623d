/* Saves what one browser shows as a picture. viser's own picture sees no further than 1000 units,
which are mm here: nothing. So the scene is drawn once more with its own camera, and copied at once,
on the page's ground. */
const { gl, camera } = window.__viserMutable.scene.__r3f.root.getState();
const scene = window.__viserMutable.scene;
const ratio = gl.getPixelRatio();
const shown = gl.domElement;
gl.setPixelRatio(Math.max(ratio, WIDTH / shown.clientWidth));
gl.render(scene, camera);
const copy = document.createElement("canvas");
copy.width = shown.width;
copy.height = shown.height;
const drawing = copy.getContext("2d");
drawing.fillStyle = GROUND;
drawing.fillRect(0, 0, copy.width, copy.height);
drawing.drawImage(shown, 0, 0);
gl.setPixelRatio(ratio);
gl.render(scene, camera);
copy.toBlob((blob) => {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = NAME;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}, "image/png");
