/** The eight steps: what is set, which planes are told of, and the words. */
const STEPS = [
  {
    title: "1. Light alone",
    set: { width: 0.06, position: 0, travel: 1, at: 0.5, fill: 0, glossy: 0 },
    planes: ["light"],
    words: "A light of width w shines alike in all directions: a band in ray space. Its spectrum lies on the line ν = 0, and falls along ρ as sinc(w ρ). " +
      "The window, through which we look, makes the line as thick as one over its own width. Drag the width: the wider the light, the shorter its spectrum.",
  },
  {
    title: "2. Travel shears",
    set: { width: 0.06, position: 0, travel: 1, at: 0.5, fill: 0, glossy: 0 },
    planes: ["light", "before_blockers", "receiver"],
    words: "After a distance d a ray of slope u has moved by d u. Ray space shears along x. Its spectrum shears the other way, along ν: what was at (ρ, ν) is now at (ρ, ν − d ρ). " +
      "The dashed line is ν = −d ρ. Drag the receiver and see it tilt.",
  },
  {
    title: "3. Blockers multiply",
    set: { width: 0.06, position: 0, travel: 1, at: 0.5, pitch: 0.06, fill: 0.5, glossy: 0 },
    planes: ["before_blockers", "after_blockers"],
    words: "Blockers multiply the light field by 0 or 1 at each position. A product in ray space is a convolution in Fourier space, so the spectrum is replicated along ρ, at multiples of one over the pitch. " +
      "Drag the pitch: closer blockers push the replicas apart. Drag the fill: it says how strong each one is.",
  },
  {
    title: "4. Travel again",
    set: { width: 0.06, position: 0, travel: 1.2, at: 0.5, pitch: 0.06, fill: 0.5, glossy: 0 },
    planes: ["after_blockers", "receiver"],
    words: "The replicas shear with all the rest. Their centres lie on the line of the blockers, ν = −h ρ, where h is the distance from them. Each is tilted along the line of the light. " +
      "Drag the blockers towards the receiver: their line flattens, and the shadows get sharp.",
  },
  {
    title: "5. A diffuse receiver keeps ν = 0",
    set: { width: 0.06, position: 0, travel: 1, at: 0.8, pitch: 0.06, fill: 0.5, glossy: 0 },
    planes: ["irradiance", "leaving"],
    words: "The cosine multiplies by a smooth function of slope, and so blurs a little along ν. Then all directions are added up: of the spectrum only the line ν = 0 is left. " +
      "Content that shear has carried away from that line is lost, and that is why the shadow of small or distant blockers fades. Drag the blockers towards the light.",
  },
  {
    title: "6. Curvature shears the other way",
    set: { width: 0.06, position: 0, travel: 1, at: 0.5, pitch: 0.06, fill: 0.5, glossy: 1, curvature: 0.8, exponent: 400 },
    planes: ["receiver", "curvature"],
    words: "Seen from the normal at each place of a curved surface, directions turn with position. Ray space shears along its slopes, and the spectrum along ρ: what was at (ρ, ν) is now at (ρ + k ν, ν). " +
      "On the surface positions are counted the other way, which turns the picture over. Drag the curvature: what lies at ν = 0 stays, the rest slides along ρ.",
  },
  {
    title: "7. A glossy lobe is a low-pass",
    set: { width: 0.06, position: 0, travel: 1, at: 0.5, pitch: 0.06, fill: 0.5, glossy: 1, curvature: 0.8, exponent: 100 },
    planes: ["curvature", "reflection"],
    words: "Reflection convolves over directions with the lobe of the surface. In Fourier space that is a product with the transform of the lobe, which takes high ν away. " +
      "Drag the exponent: a broad lobe leaves a thin line about ν = 0, as a diffuse surface does. A narrow one lets all pass, as a mirror does.",
  },
  {
    title: "8. How many samples it takes",
    set: { width: 0.06, position: 0, travel: 1, at: 0.5, pitch: 0.06, fill: 0.5, glossy: 1, curvature: 0.8, exponent: 100 },
    planes: ["reflection", "leaving"],
    words: "On its way back from the local normals light is sheared by the curvature once more, and then it travels to the eye. So the cutoff of the lobe, the curvature, and the distance of the blockers say how fast the image changes: " +
      "the criterion stands below. Two samples to a cycle of that are enough. Drag the curvature and the exponent, and read it.",
  },
];
