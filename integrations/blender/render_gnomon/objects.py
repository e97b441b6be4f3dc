# SPDX-License-Identifier: MIT
"""Names properties of Blender's objects that are not drawn as a render draws them."""


def light_remarks_of(thing):
    """Sentences about the light of a lamp or of an object with a surface."""
    # Blender 4.0 and later.
    linking = getattr(thing, 'light_linking', None)
    if linking is not None and (linking.receiver_collection or linking.blocker_collection):
        return ["its light linking is not drawn: its light reaches all objects, and all objects block it"]
    return []


def remarks_of(thing, view_layer):
    """Sentences about an object with a surface."""
    remarks = light_remarks_of(thing)
    if thing.is_holdout or thing.is_shadow_catcher or thing.holdout_get(view_layer=view_layer):
        remarks.append("holdouts and shadow catchers are drawn as surfaces")
    if not thing.visible_camera or thing.indirect_only_get(view_layer=view_layer):
        remarks.append("it is hidden from the camera in Blender and is drawn")
    hidden = [kind for kind in ('diffuse', 'glossy', 'transmission') if not getattr(thing, f'visible_{kind}')]
    if hidden:
        remarks.append(f"it is hidden from rays of the kinds {', '.join(hidden)}, which is not drawn")
    return remarks
