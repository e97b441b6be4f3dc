// SPDX-License-Identifier: MIT
// Branches of fragment shaders that uniform blocks decide.

/**
 * \a value: a member of a uniform block, or made from members alone, that bounds a loop or decides whether much code runs. Mesa's lavapipe
 * would make it a constant, and compile the program again in each pass. It does not know that the other summand is 0.
 */
int branch_value(int value)
{
#ifdef VULKAN
  return value + int(gl_FragCoord.x < 0.0);
#else
  return value;
#endif
}
