// SPDX-License-Identifier: MIT
#include "shader_check_interfaces.hh"

#include "shader_check_reflection.hh"

#include "gpu/gpu_testing.hh"

namespace gnomon::shader_check {
namespace {

using test::error_of;
using test::expect_contains;
using test::ShaderTexts;
using test::VERSION;

/** Entries of the program "test" with the stage \a vertex, one for each list of defines, with keys from 0. */
std::vector<VariantInterfaces> interfaces(const std::string &vertex,
                                          const std::vector<std::vector<std::string>> &variants,
                                          const std::vector<std::uint32_t> &keys = {0, 1, 2})
{
  const ShaderTexts texts{{{"vert", VERSION + vertex}, {"frag", VERSION + "void main() {}\n"}}};
  std::vector<TableEntry> entries;
  for (std::size_t i = 0; i < variants.size(); i++) {
    entries.push_back({keys[i], {"test", "vert", "", "frag", variants[i]}});
  }
  return variant_interfaces(entries, texts.files());
}

/** Reads a_block with A, b_block and the push constants with B, picture always. */
const std::string PARTS = R"(
layout(std140, binding = 1) uniform a_block { vec4 a; vec4 more_a; };
layout(std140, binding = 2) readonly buffer b_block { vec4 b; };
layout(std140, binding = 8) uniform push_constant_block { vec4 pushed; };
layout(binding = 3) uniform sampler2D picture;
#ifdef B
layout(location = 1) out mat2 passed;
#endif
void main()
{
#ifdef B
  passed = mat2(1.0);
#endif
  gl_Position = texture(picture, vec2(0.0));
#ifdef A
  gl_Position += a;
#endif
#ifdef B
  gl_Position += b + pushed;
#endif
}
)";

TEST(VariantInterfaces, HaveOneListAndAMaskForEachVariant)
{
  const std::vector<VariantInterfaces> programs = interfaces(PARTS, {{}, {"A"}, {"A", "B"}});
  ASSERT_EQ(programs.size(), 1U);
  const VariantInterfaces &program = programs[0];
  EXPECT_EQ(program.name, "test");
  ASSERT_EQ(program.all.bindings.size(), 3U);
  EXPECT_EQ(program.all.bindings[0].name, "a_block");
  EXPECT_EQ(program.all.bindings[1].name, "b_block");
  EXPECT_EQ(program.all.bindings[2].name, "picture");
  EXPECT_EQ(program.all.push_constant_size_bytes, 16U);
  ASSERT_EQ(program.variants.size(), 3U);
  EXPECT_EQ(program.variants[0].bindings, 0b100U);
  EXPECT_EQ(program.variants[1].bindings, 0b101U);
  EXPECT_EQ(program.variants[2].bindings, 0b111U);
  EXPECT_FALSE(program.variants[1].has_push_constants);
  EXPECT_TRUE(program.variants[2].has_push_constants);
}

TEST(VariantInterfaces, TheTableHoldsAllOfThem)
{
  const std::string text = table_source(interfaces(PARTS, {{}, {"A"}, {"A", "B"}}), "some_header.hh", "some::tables");
  expect_contains(text, "#include \"some_header.hh\"");
  expect_contains(text, "std::span<const InterfaceTable> some::tables()");
  expect_contains(text, R"({"a", 0, 16},)");
  expect_contains(text, R"({"more_a", 16, 16},)");
  expect_contains(text, R"({"b_block", BindingKind::StorageBlock, 2, 16, )");
  expect_contains(text, "{0x2, 0x7, true, false, 3},");
}

TEST(VariantInterfaces, OneNameHasOneSlot)
{
  const std::string message = error_of([] {
    interfaces("layout(std140, binding = SLOT) uniform a_block { vec4 a; };\nvoid main() { gl_Position = a; }\n",
               {{"SLOT 1"}, {"SLOT 2"}});
  });
  for (const char *part : {"'test'", "'a_block'", "slot 1", "'SLOT 1'", "slot 2", "'SLOT 2'"}) {
    expect_contains(message, part);
  }
}

TEST(VariantInterfaces, OneNameHasOneLayout)
{
  const std::string vertex =
      "layout(std140, binding = 1) uniform BLOCK { MEMBERS };\nvoid main() { gl_Position = vec4(x); }\n";
  for (const char *block : {"BLOCK a_block", "BLOCK push_constant_block"}) {
    const std::string message = error_of([&] {
      interfaces(vertex, {{block, "MEMBERS float x;"}, {block, "MEMBERS vec4 y; float x;"}});
    });
    expect_contains(message, "'test'");
    expect_contains(message, "MEMBERS float x;");
    expect_contains(message, "MEMBERS vec4 y; float x;");
  }
}

TEST(VariantInterfaces, OneSlotHasOneName)
{
  const std::string message = error_of([] {
    interfaces("layout(std140, binding = 1) uniform NAME { vec4 a; };\nvoid main() { gl_Position = a; }\n",
               {{"NAME a_block"}, {"NAME b_block"}});
  });
  for (const char *part : {"'test'", "slot 1", "'a_block'", "'b_block'"}) {
    expect_contains(message, part);
  }
}

TEST(VariantInterfaces, OneKeyHasOneInterface)
{
  EXPECT_EQ(error_of([] { interfaces(PARTS, {{"A"}, {"A", "C 1"}}, {5, 5}); }), "");
  const std::string message = error_of([] { interfaces(PARTS, {{"A"}, {"B"}}, {5, 5}); });
  for (const char *part : {"'test'", "0x5", "'A'", "'B'"}) {
    expect_contains(message, part);
  }
}

TEST(VariantInterfaces, AVariantThatDoesNotCompileIsAnErrorThatNamesTheLine)
{
  expect_contains(error_of([] { interfaces("void main() { gl_Position = nothing; }\n", {{}}); }), "vert:2");
}

constexpr gpu::InterfaceTable::Member members[] = {{"a", 0, 16}, {"b", 16, 4}};
constexpr gpu::InterfaceTable::Binding bindings[] = {{"a_block", gpu::BindingKind::UniformBlock, 3, 32, members},
                                                     {"picture", gpu::BindingKind::Texture, 17, 0, {}}};
constexpr gpu::InterfaceTable::Variant variants[] = {{4, 0b11, true, true, 3}, {6, 0b10, false, false, 0}};
constexpr gpu::InterfaceTable table = {"test", bindings, members, 32, 8, variants};

TEST(InterfaceTable, GivesTheInterfaceOfAVariant)
{
  const gpu::ShaderInterface all = table.interface_of(4);
  ASSERT_EQ(all.bindings.size(), 2U);
  EXPECT_EQ(all.bindings[0], (gpu::ShaderInterface::Binding{
                                 "a_block", gpu::BindingKind::UniformBlock, 3, 32, {{"a", 0, 16}, {"b", 16, 4}}}));
  EXPECT_EQ(all.push_constant_size_bytes, 32U);
  EXPECT_EQ(all.push_constant_slot, 8);
  EXPECT_EQ(all.push_constant_members.size(), 2U);
  EXPECT_TRUE(all.reads_object);
  EXPECT_EQ(all.varying_locations, 3);

  const gpu::ShaderInterface part = table.interface_of(6);
  ASSERT_EQ(part.bindings.size(), 1U);
  EXPECT_EQ(part.bindings[0].name, "picture");
  EXPECT_EQ(part.push_constant_size_bytes, 0U);
  EXPECT_FALSE(part.reads_object);
}

TEST(InterfaceTable, AVariantThatItDoesNotHoldIsAnErrorThatNamesIt)
{
  const std::string message = error_of([] { static_cast<void>(table.interface_of(5)); });
  expect_contains(message, "'test'");
  expect_contains(message, "0x5");
}

}  // namespace
}  // namespace gnomon::shader_check
