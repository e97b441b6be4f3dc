# SPDX-License-Identifier: MIT
# Types of the module. help(gnomon.Lamp) and the like have units and ranges. ..._Properties are the arguments of edit() and add_...().
from os import PathLike
from typing import Callable, Literal, Sequence, TypedDict

import numpy as np
from numpy.typing import ArrayLike, NDArray
from typing_extensions import Unpack

Vector = tuple[float, float, float]
Background = None | Literal["world"] | Sequence[float]

class Error(Exception): ...
class FileError(Error): ...
class StaleHandle(Error): ...
class InvalidEdit(Error): ...
class DeviceError(Error): ...
class DeviceLost(DeviceError): ...

class _Enum:
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class LampKind(_Enum):
    POINT: LampKind
    SUN: LampKind
    SPOT: LampKind
    HEMI: LampKind
    AREA: LampKind

class AreaShape(_Enum):
    RECTANGLE: AreaShape
    ELLIPSE: AreaShape

class ShadowKind(_Enum):
    NONE: ShadowKind
    HARD: ShadowKind
    PCF: ShadowKind
    ESM: ShadowKind
    EVSM: ShadowKind

class AlphaMode(_Enum):
    OPAQUE: AlphaMode
    MASK: AlphaMode
    BLEND: AlphaMode

class CameraKind(_Enum):
    PERSPECTIVE: CameraKind
    ORTHOGRAPHIC: CameraKind

class _LampProperties(TypedDict, total=False):
    name: str
    kind: LampKind
    color: Sequence[float]
    intensity: float
    radius: float
    angle: float
    spot_outer_angle: float
    spot_blend: float
    range: float
    area_shape: AreaShape
    area_size_x: float
    area_size_y: float
    shadow_kind: ShadowKind | None
    shadow_size_px: int | None
    shadow_bias: float | None
    shadow_clip_start: float | None
    shadow_clip_end: float | None
    shadow_exponent: float | None
    shadow_filter_angle: float | None
    shadow_esm_size_px: int | None

class Lamp:
    name: str
    kind: LampKind
    color: Vector
    intensity: float
    radius: float
    angle: float
    spot_outer_angle: float
    spot_blend: float
    range: float
    area_shape: AreaShape
    area_size_x: float
    area_size_y: float
    shadow_kind: ShadowKind | None
    shadow_size_px: int | None
    shadow_bias: float | None
    shadow_clip_start: float | None
    shadow_clip_end: float | None
    shadow_exponent: float | None
    shadow_filter_angle: float | None
    shadow_esm_size_px: int | None
    def edit(self, **properties: Unpack[_LampProperties]) -> None: ...

class _SurfaceFunctionProperties(TypedDict, total=False):
    name: str
    text: str
    path: str

class SurfaceFunction:
    name: str
    text: str
    path: str
    def edit(self, **properties: Unpack[_SurfaceFunctionProperties]) -> None: ...

class _MaterialProperties(TypedDict, total=False):
    name: str
    base_color: Sequence[float]
    alpha: float
    alpha_mode: AlphaMode
    alpha_cutoff: float
    metallic: float
    roughness: float
    normal_scale: float
    occlusion_strength: float
    specular: float
    specular_color: Sequence[float]
    coat: float
    coat_roughness: float
    coat_normal_scale: float
    sheen_color: Sequence[float]
    sheen_roughness: float
    anisotropy: float
    anisotropy_rotation: float
    transmission: float
    thickness: float
    ior: float
    attenuation_distance: float
    attenuation_color: Sequence[float]
    emissive: Sequence[float]
    is_unlit: bool
    is_double_sided: bool
    surface_function: SurfaceFunction | None
    base_color_texture: Texture | None
    metallic_roughness_texture: Texture | None
    normal_texture: Texture | None
    occlusion_texture: Texture | None
    emissive_texture: Texture | None
    specular_texture: Texture | None
    specular_color_texture: Texture | None
    coat_texture: Texture | None
    coat_roughness_texture: Texture | None
    sheen_color_texture: Texture | None
    sheen_roughness_texture: Texture | None
    anisotropy_texture: Texture | None
    coat_normal_texture: Texture | None
    transmission_texture: Texture | None
    thickness_texture: Texture | None

class Material:
    name: str
    base_color: Vector
    alpha: float
    alpha_mode: AlphaMode
    alpha_cutoff: float
    metallic: float
    roughness: float
    normal_scale: float
    occlusion_strength: float
    specular: float
    specular_color: Vector
    coat: float
    coat_roughness: float
    coat_normal_scale: float
    sheen_color: Vector
    sheen_roughness: float
    anisotropy: float
    anisotropy_rotation: float
    transmission: float
    thickness: float
    ior: float
    attenuation_distance: float
    attenuation_color: Vector
    emissive: Vector
    is_unlit: bool
    is_double_sided: bool
    surface_function: SurfaceFunction | None
    base_color_texture: Texture | None
    metallic_roughness_texture: Texture | None
    normal_texture: Texture | None
    occlusion_texture: Texture | None
    emissive_texture: Texture | None
    specular_texture: Texture | None
    specular_color_texture: Texture | None
    coat_texture: Texture | None
    coat_roughness_texture: Texture | None
    sheen_color_texture: Texture | None
    sheen_roughness_texture: Texture | None
    anisotropy_texture: Texture | None
    coat_normal_texture: Texture | None
    transmission_texture: Texture | None
    thickness_texture: Texture | None
    def edit(self, **properties: Unpack[_MaterialProperties]) -> None: ...

class Texture:
    @property
    def name(self) -> str: ...
    @property
    def texels(self) -> NDArray[np.uint8]: ...
    @texels.setter
    def texels(self, value: NDArray[np.uint8]) -> None: ...

class _CameraProperties(TypedDict, total=False):
    name: str
    kind: CameraKind
    vertical_angle: float
    aspect: float
    half_width: float
    half_height: float
    near: float
    far: float

class Camera:
    name: str
    kind: CameraKind
    vertical_angle: float
    aspect: float
    half_width: float
    half_height: float
    near: float
    far: float
    def edit(self, **properties: Unpack[_CameraProperties]) -> None: ...

class _MeshProperties(TypedDict, total=False):
    name: str
    material: Material | None
    positions: NDArray[np.float32]
    normals: NDArray[np.float32]
    uvs: NDArray[np.float32]
    triangles: NDArray[np.uint32]

class Mesh:
    name: str
    material: Material | None
    @property
    def positions(self) -> NDArray[np.float32]: ...
    @positions.setter
    def positions(self, value: NDArray[np.float32]) -> None: ...
    @property
    def normals(self) -> NDArray[np.float32]: ...
    @normals.setter
    def normals(self, value: NDArray[np.float32]) -> None: ...
    @property
    def uvs(self) -> NDArray[np.float32]: ...
    @uvs.setter
    def uvs(self, value: NDArray[np.float32]) -> None: ...
    @property
    def triangles(self) -> NDArray[np.uint32]: ...
    @triangles.setter
    def triangles(self, value: NDArray[np.uint32]) -> None: ...
    def edit(self, **properties: Unpack[_MeshProperties]) -> None: ...

class _NodeProperties(TypedDict, total=False):
    name: str
    parent_from_node: ArrayLike
    position: Sequence[float]
    meshes: Sequence[Mesh]
    lamp: Lamp | None
    camera: Camera | None
    is_visible: bool
    casts_shadow: bool
    receives_shadow: bool

class Node:
    name: str
    @property
    def parent_from_node(self) -> NDArray[np.float64]: ...
    @parent_from_node.setter
    def parent_from_node(self, value: ArrayLike) -> None: ...
    position: Vector
    meshes: list[Mesh]
    lamp: Lamp | None
    camera: Camera | None
    is_visible: bool
    casts_shadow: bool
    receives_shadow: bool
    parent: Node | None
    @property
    def world_from_node(self) -> NDArray[np.float64]: ...
    def edit(self, **properties: Unpack[_NodeProperties]) -> None: ...

class Scene:
    def __init__(self) -> None: ...
    @property
    def nodes(self) -> list[Node]: ...
    @property
    def meshes(self) -> list[Mesh]: ...
    @property
    def surface_functions(self) -> list[SurfaceFunction]: ...
    @property
    def materials(self) -> list[Material]: ...
    @property
    def textures(self) -> list[Texture]: ...
    @property
    def lamps(self) -> list[Lamp]: ...
    @property
    def cameras(self) -> list[Camera]: ...
    @property
    def warnings(self) -> list[str]: ...
    @property
    def bounds(self) -> tuple[Vector, Vector] | None: ...
    def add_node(self, parent: Node | None = None, **properties: Unpack[_NodeProperties]) -> Node: ...
    def add_mesh(
        self,
        positions: NDArray[np.float32],
        normals: NDArray[np.float32],
        triangles: NDArray[np.uint32],
        uvs: NDArray[np.float32] | None = None,
        *,
        name: str = "",
        material: Material | None = None,
    ) -> Mesh: ...
    def add_material(self, **properties: Unpack[_MaterialProperties]) -> Material: ...
    def add_texture(self, source: NDArray[np.uint8] | str | PathLike[str], name: str = "") -> Texture: ...
    def add_surface_function(self, **properties: Unpack[_SurfaceFunctionProperties]) -> SurfaceFunction: ...
    def add_lamp(self, **properties: Unpack[_LampProperties]) -> Lamp: ...
    def add_camera(self, **properties: Unpack[_CameraProperties]) -> Camera: ...
    def remove(self, thing: Node | Mesh | Material | Texture | SurfaceFunction | Lamp | Camera) -> None: ...
    def set_world(
        self,
        color: Sequence[float] = (1.0, 1.0, 1.0),
        strength: float = 1.0,
        rotation: float = 0.0,
        picture: NDArray[np.float32] | None = None,
    ) -> None: ...
    def remove_world(self) -> None: ...
    def save(self, path: str | PathLike[str]) -> None: ...

class Device:
    def __init__(self) -> None: ...
    @property
    def description(self) -> str: ...
    @property
    def memory_bytes(self) -> int: ...

class Report:
    @property
    def warnings(self) -> list[str]: ...
    @property
    def limits(self) -> list[str]: ...
    @property
    def sample_count(self) -> int: ...
    @property
    def frame_seconds(self) -> float: ...
    @property
    def memory_bytes(self) -> int: ...

class _OfflineProperties(TypedDict, total=False):
    seed: int
    noise_threshold: float
    light_threshold: float
    emissive_point_count: int
    has_multiscatter: bool
    background: Background
    shadow_kind: ShadowKind
    cube_size_px: int
    map_size_px: int
    esm_size_px: int
    cascade_count: int
    shadow_bytes_max: int

class _RendererProperties(_OfflineProperties, total=False):
    sample_count: int

class Renderer:
    sample_count: int
    seed: int
    noise_threshold: float
    light_threshold: float
    emissive_point_count: int
    has_multiscatter: bool
    background: Background
    shadow_kind: ShadowKind
    cube_size_px: int
    map_size_px: int
    esm_size_px: int
    cascade_count: int
    shadow_bytes_max: int
    size: tuple[int, int]
    def __init__(self, device: Device, scene: Scene, size: tuple[int, int], **properties: Unpack[_RendererProperties]) -> None: ...
    @staticmethod
    def offline(
        device: Device, scene: Scene, size: tuple[int, int], sample_count: int = 16, **properties: Unpack[_OfflineProperties]
    ) -> Renderer: ...
    def render(self, camera: Node | None = None, seconds_max: float = ...) -> NDArray[np.float32]: ...
    def report(self) -> Report: ...

def load(
    path: str | PathLike[str],
    variant: str = "",
    progress: Callable[[float], object] | None = None,
    only_below: str | PathLike[str] | None = None,
) -> Scene: ...

# Where Gnomon is built with its reference.
class ImageError:
    @property
    def rmse(self) -> float: ...
    @property
    def relative_mse(self) -> float: ...
    @property
    def p99(self) -> float: ...
    @property
    def flip(self) -> float: ...
    @property
    def non_finite_count(self) -> int: ...

def trace(
    scene: Scene, size: tuple[int, int], camera: Node | None = None, sample_count: int = 64,
    has_multiscatter: bool = False
) -> tuple[NDArray[np.float32], float]: ...
def image_error(picture: NDArray[np.float32], reference: NDArray[np.float32]) -> ImageError: ...
