# SPDX-License-Identifier: MIT
"""Settings of the engine in Blender, made from the descriptions in Gnomon's Python module.

A setting that the user has not set is not given to Gnomon, which then chooses it as `gnomon render` does.
"""

import bpy

try:
    import gnomon
    MISSING = ""
except ImportError as error:
    gnomon = None
    MISSING = str(error)

MIB = 2**20
INT_MAX = 2**31 - 1
# Film > Transparent is the background.
DESCRIPTIONS = {name: each for name, each in gnomon.Renderer.descriptions().items() if name != 'background'} if gnomon else {}


def redraw_viewports():
    """Asks for a new drawing of the viewports that Gnomon may draw."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == 'VIEW_3D' and area.spaces.active.shading.type == 'RENDERED':
                area.tag_redraw()


def title(name, description):
    text = description.label if description.label != name else name.replace('_', ' ').capitalize()
    unit = {'rad': '', 'bytes': 'MiB'}.get(description.unit, description.unit)
    return f"{text} ({unit})" if unit else text


def property_of(name, description):
    """A property of Blender with the name, sentence, limits and default of a setting."""
    is_absent = description.default is None
    # Blender adds the last full stop.
    facts = {'name': title(name, description), 'description': description.sentence.removesuffix('.'),
             'update': lambda own, context: redraw_viewports()}
    kind = description.type.removesuffix(' | None')
    if kind == 'bool' and description.words == ['off', 'on']:
        return bpy.props.BoolProperty(default=description.default, **facts)
    if description.words:
        items = [(word, word, "", number) for number, word in enumerate(description.words)]
        words = [str(number) for number in range(len(items))]
        default = description.words[0] if is_absent else description.words[number_of(description, words)]
        return bpy.props.EnumProperty(items=items, default=default, **facts)
    if kind == 'str':
        return bpy.props.StringProperty(default=description.default, **facts)
    least = 0 if description.zero else description.min
    default = max(least, description.min) if is_absent else description.default
    if kind == 'int':
        scale = MIB if description.unit == 'bytes' else 1
        return bpy.props.IntProperty(
            default=min(int(default) // scale, INT_MAX), min=max(int(least) // scale, -INT_MAX), max=min(int(description.max) // scale, INT_MAX), **facts)
    subtype = 'ANGLE' if description.unit == 'rad' else 'NONE'
    return bpy.props.FloatProperty(default=default, min=least, max=description.max, subtype=subtype, precision=3, **facts)


def number_of(description, words):
    """The number of a default among its words."""
    if isinstance(description.default, bool):
        return int(description.default)
    if isinstance(description.default, str):
        return description.words.index(description.default)
    return words.index(str(int(description.default)))


def value_of(name, description, value):
    """A value of Blender's property as Gnomon has it."""
    kind = description.type.removesuffix(' | None')
    if kind == 'bool' and isinstance(value, str):
        return bool(description.words.index(value))
    if kind == 'int' and description.unit == 'bytes':
        return value * MIB
    if hasattr(gnomon, kind):
        return getattr(gnomon, kind)(description.words.index(value))
    return value


def chosen(settings):
    """The properties of a renderer that the user has set, without sample_count."""
    return {name: value_of(name, each, getattr(settings, name)) for name, each in DESCRIPTIONS.items()
            if name != 'sample_count' and settings.is_property_set(name)}


class GnomonSettings(bpy.types.PropertyGroup):
    """A property for each description."""

    __annotations__ = {name: property_of(name, each) for name, each in DESCRIPTIONS.items()}


class GNOMON_OT_unset(bpy.types.Operator):
    bl_idname = 'gnomon.unset'
    bl_label = "Choose Automatically"
    bl_description = "Let Gnomon choose this setting"
    bl_options = {'UNDO', 'INTERNAL'}

    setting: bpy.props.StringProperty()

    def execute(self, context):
        context.scene.gnomon.property_unset(self.setting)
        redraw_viewports()
        return {'FINISHED'}


class EnginePanel:
    bl_space_type = 'PROPERTIES'
    bl_region_type = 'WINDOW'
    COMPAT_ENGINES = {'GNOMON'}

    @classmethod
    def poll(cls, context):
        return context.engine in cls.COMPAT_ENGINES


class SettingsPanel(EnginePanel):
    bl_context = 'render'

    @staticmethod
    def has(name, description):
        raise NotImplementedError

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        if MISSING:
            layout.label(text=f"Gnomon's Python module is missing: {MISSING}", icon='ERROR')
        settings = context.scene.gnomon
        for name, description in DESCRIPTIONS.items():
            if self.has(name, description):
                row = layout.row(align=True)
                is_set = settings.is_property_set(name) or name == 'sample_count'
                part = row.row(align=True)
                part.active = is_set
                part.prop(settings, name)
                if is_set and name != 'sample_count':
                    row.operator('gnomon.unset', text="", icon='X').setting = name


class GNOMON_PT_picture(SettingsPanel, bpy.types.Panel):
    bl_label = "Picture"

    @staticmethod
    def has(name, description):
        return not description.group and description.label != name

    def draw(self, context):
        super().draw(context)
        self.layout.prop(context.scene.render, 'film_transparent')


class GNOMON_PT_shadows(SettingsPanel, bpy.types.Panel):
    bl_label = "Shadow Settings"
    bl_options = {'DEFAULT_CLOSED'}

    @staticmethod
    def has(name, description):
        return bool(description.group)


class GNOMON_PT_others(SettingsPanel, bpy.types.Panel):
    bl_label = "Further Settings"
    bl_options = {'DEFAULT_CLOSED'}

    @staticmethod
    def has(name, description):
        return not description.group and description.label == name


CLASSES = (GnomonSettings, GNOMON_OT_unset, GNOMON_PT_picture, GNOMON_PT_shadows, GNOMON_PT_others)


def register():
    for each in CLASSES:
        bpy.utils.register_class(each)
    bpy.types.Scene.gnomon = bpy.props.PointerProperty(type=GnomonSettings)


def unregister():
    del bpy.types.Scene.gnomon
    for each in reversed(CLASSES):
        bpy.utils.unregister_class(each)
