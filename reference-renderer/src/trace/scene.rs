//! Scenes: shapes and their materials under an environment. +z is up.
//!
//! A scene is made of parts, each with a [`Role`]; it builds those alone that it has, and asks for the materials of those alone.

use crate::numbers::random::Random;
use crate::shade::shader::Shader;
use crate::trace::camera::Camera;
use crate::world::ball::Ball;
use crate::world::bulb::Bulb;
use crate::world::environment::Environment;
use crate::world::intersect::TriangleTree;
use crate::world::mesh::Mesh;
use crate::world::ray::Ray;
use crate::world::skin::Skin;
use crate::world::teapot;
use glam::{Vec2, Vec3, vec3};
use std::f32::consts::TAU;

/// Quadrilaterals along each side of a patch of the teapot: at 24 the outline shows no corners in 4096 pixels.
const TEAPOT_STEPS: u32 = 24;

/// Height of the ground below what stands on z = 0: so that no two surfaces coincide.
const GROUND_HEIGHT: f32 = -1e-3;

/// Half the side of the ground.
const GROUND_HALF_SIDE: f32 = 60.0;

/// Side of a tile of a floor of many materials.
const TILE: f32 = 2.0;

/// Largest side of a mesh that stands on the ground: about the teapot's height, so that it fills the picture.
const MESH_SIZE: f32 = 3.4;

/// The room: half its width and depth, its height, and what stands in it: size and place of the teapot, and the ball.
const ROOM: Vec3 = vec3(5.0, 4.0, 6.0);
const ROOM_OBJECT: (f32, Vec3) = (0.85, vec3(-1.4, 0.6, 0.0));
const ROOM_BALL: Ball = Ball { centre: vec3(2.9, -1.2, 1.25), radius: 1.25 };

/// The lamp: its foot on the ground, the shade, the bulb in it, and the wall behind.
const LAMP_FOOT: Ball = Ball { centre: vec3(0.0, 0.0, 0.5), radius: 0.5 };
const SHADE: Cylinder = Cylinder { radius: 0.85, low: 1.15, high: 2.6 };
const BULB: Bulb =
    Bulb { ball: Ball { centre: vec3(0.0, 0.0, 1.85), radius: 0.4 }, radiance: vec3(12.0, 9.0, 5.4) };
const LAMP_WALL: f32 = 1.6;

/// The room with a window: half its width and depth, its height; the window in the wall at -x, its least and its largest y and z; the ball.
const CHAMBER: Vec3 = vec3(3.0, 3.0, 3.0);
const WINDOW: [[f32; 2]; 2] = [[-1.6, 0.6], [2.2, 2.6]];
const CHAMBER_BALL: Ball = Ball { centre: vec3(-0.9, 1.3, 0.6), radius: 0.6 };

/// Which scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum SceneName {
    /// A sphere of radius 1 that floats in the environment.
    Sphere,
    /// The Utah teapot on a plane.
    Teapot,
    /// The mesh that --mesh names, on a plane.
    Statue,
    /// The sphere under the same light from everywhere: rendered beside expected radiance.
    Furnace,
    /// Teapot and ball in a room of a floor and three walls, open to the light above and in front.
    Room,
    /// A bulb in a shade that is a sheet, before a wall.
    LampShade,
    /// A room whose window is covered by a sheet, under the light outside.
    Window,
}

/// The role of a part of a scene, by which it has its material.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The subject of the picture.
    Object,
    /// The ground, and the wall behind it.
    Ground,
    /// The ball beside it.
    Ball,
    /// The wall on the left.
    Left,
    /// The wall on the right.
    Right,
}

impl Role {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Object, Self::Ground, Self::Ball, Self::Left, Self::Right];

    /// Its name.
    pub fn text(self) -> &'static str {
        match self {
            Self::Object => "object",
            Self::Ground => "ground",
            Self::Ball => "ball",
            Self::Left => "left wall",
            Self::Right => "right wall",
        }
    }
}

/// Where a camera stands by itself.
#[derive(Clone, Copy, Debug)]
pub struct Standpoint {
    pub eye: Vec3,
    pub target: Vec3,
    /// Degrees that the shorter side of the picture sees.
    pub view_angle: f32,
}

impl Standpoint {
    /// The camera that stands there.
    pub fn camera(&self, size: [u32; 2]) -> Camera {
        Camera::new(self.eye, self.target, self.view_angle.to_radians(), size)
    }
}

impl SceneName {
    /// As it is written.
    pub fn text(self) -> &'static str {
        match self {
            Self::Sphere => "sphere",
            Self::Teapot => "teapot",
            Self::Statue => "statue",
            Self::Furnace => "furnace",
            Self::Room => "room",
            Self::LampShade => "lamp-shade",
            Self::Window => "window",
        }
    }

    /// Where the camera stands.
    pub fn standpoint(self) -> Standpoint {
        let at = |eye, target, view_angle| Standpoint { eye, target, view_angle };
        match self {
            Self::Sphere | Self::Furnace => at(vec3(0.0, -6.0, 0.6), Vec3::ZERO, 24.0),
            Self::Teapot => at(vec3(3.6, -9.6, 5.2), vec3(0.15, 0.0, 1.25), 27.0),
            Self::Statue => at(vec3(2.4, -9.6, 3.6), vec3(0.0, 0.0, 1.6), 25.0),
            Self::Room => at(vec3(0.5, -13.5, 4.2), vec3(0.1, 0.0, 2.4), 36.0),
            Self::LampShade => at(vec3(2.2, -8.0, 2.6), vec3(0.0, 0.4, 1.75), 32.0),
            Self::Window => at(vec3(2.8, -2.7, 1.6), vec3(-1.8, 1.6, 0.9), 62.0),
        }
    }

    /// The camera that shows the scene.
    pub fn camera(self, size: [u32; 2]) -> Camera {
        self.standpoint().camera(size)
    }

    /// Whether it is the sphere alone, which is met in closed form, and of which the mean radiance under a constant light is known.
    pub fn is_sphere(self) -> bool {
        matches!(self, Self::Sphere | Self::Furnace)
    }

    /// Whether its object is a sheet.
    pub fn has_sheet(self) -> bool {
        matches!(self, Self::LampShade | Self::Window)
    }

    /// Whether a mesh may be its object.
    pub fn takes_mesh(self) -> bool {
        matches!(self, Self::Teapot | Self::Statue | Self::Room)
    }

    /// The light that it has by itself. Through a sheet no sample finds the sharp sun of `sky`, seen from a wall.
    pub fn light(self) -> &'static str {
        match self {
            Self::Furnace => "constant:1",
            Self::LampShade => "constant:0.03",
            Self::Window => "haze",
            Self::Sphere | Self::Teapot | Self::Statue | Self::Room => "sky",
        }
    }

    /// The parts that it has.
    pub fn roles(self) -> &'static [Role] {
        match self {
            Self::Sphere | Self::Furnace => &[Role::Object],
            Self::Teapot | Self::Statue => &[Role::Object, Role::Ground],
            Self::LampShade | Self::Window => &[Role::Object, Role::Ground, Role::Ball],
            Self::Room => &[Role::Object, Role::Ground, Role::Ball, Role::Left, Role::Right],
        }
    }

    /// Builds its shapes; `mesh` takes the place of the teapot, and is the statue.
    pub fn shapes(self, mesh: Option<Mesh>) -> Shapes {
        let mut shapes = Shapes::default();
        let object = || match mesh {
            None => teapot::tessellate(TEAPOT_STEPS),
            Some(mut mesh) => {
                mesh.stand(MESH_SIZE);
                mesh
            }
        };
        match self {
            Self::Sphere | Self::Furnace => {
                shapes.ball = Some((Ball { centre: Vec3::ZERO, radius: 1.0 }, Role::Object));
            }
            Self::Teapot | Self::Statue => {
                shapes.add(object(), Role::Object);
                shapes.add(Mesh::square(GROUND_HALF_SIDE, GROUND_HEIGHT), Role::Ground);
            }
            Self::Room => {
                let mut object = object();
                let (size, place) = ROOM_OBJECT;
                object.positions.iter_mut().for_each(|p| *p = *p * size + place);
                shapes.add(object, Role::Object);
                shapes.ball = Some((ROOM_BALL, Role::Ball));
                let Vec3 { x, y, z: high } = ROOM;
                let low = GROUND_HEIGHT;
                let corner = |x: f32, y: f32, z: f32| vec3(x, y, z);
                let (front, back) = (-y, y);
                shapes.add(
                    Mesh::quadrilateral(
                        [(-x, front), (x, front), (x, back), (-x, back)].map(|(x, y)| corner(x, y, low)),
                    ),
                    Role::Ground,
                );
                let wall = |from: (f32, f32), to: (f32, f32)| {
                    let [(ax, ay), (bx, by)] = [from, to];
                    Mesh::quadrilateral([
                        corner(ax, ay, low),
                        corner(bx, by, low),
                        corner(bx, by, high),
                        corner(ax, ay, high),
                    ])
                };
                shapes.add(wall((-x, back), (x, back)), Role::Ground);
                shapes.add(wall((-x, front), (-x, back)), Role::Left);
                shapes.add(wall((x, back), (x, front)), Role::Right);
            }
            Self::LampShade => {
                shapes.add(SHADE.mesh(), Role::Object);
                shapes.ball = Some((LAMP_FOOT, Role::Ball));
                shapes.bulb = Some(BULB);
                shapes.add(Mesh::square(GROUND_HALF_SIDE, GROUND_HEIGHT), Role::Ground);
                let far = GROUND_HALF_SIDE;
                shapes.add(upright([-far, LAMP_WALL], [far, LAMP_WALL], [GROUND_HEIGHT, far]), Role::Ground);
            }
            Self::Window => {
                shapes.ball = Some((CHAMBER_BALL, Role::Ball));
                let Vec3 { x, y, z: high } = CHAMBER;
                let [[left, sill], [right, lintel]] = WINDOW;
                let [from, to] = [[-x, left], [-x, right]];
                // Its front is outside.
                shapes.add(upright(to, from, [sill, lintel]), Role::Object);
                let low = GROUND_HEIGHT;
                let level = |z: f32| {
                    Mesh::quadrilateral([(-x, -y), (x, -y), (x, y), (-x, y)].map(|(x, y)| vec3(x, y, z)))
                };
                let [a, b, c, d] = [[-x, -y], [x, -y], [x, y], [-x, y]];
                for part in [
                    level(low),
                    level(high),
                    upright(a, b, [low, high]),
                    upright(b, c, [low, high]),
                    upright(c, d, [low, high]),
                    // Round the window.
                    upright(d, to, [low, high]),
                    upright(from, a, [low, high]),
                    upright(to, from, [low, sill]),
                    upright(to, from, [lintel, high]),
                ] {
                    shapes.add(part, Role::Ground);
                }
            }
        }
        shapes
    }
}

/// A wall that stands on a line, between two heights; its front is on the right of one who walks along the line.
fn upright(from: [f32; 2], to: [f32; 2], [low, high]: [f32; 2]) -> Mesh {
    let corner = |[x, y]: [f32; 2], z: f32| vec3(x, y, z);
    Mesh::quadrilateral([corner(from, low), corner(to, low), corner(to, high), corner(from, high)])
}

/// An upright cylinder about the vertical, open above and below.
struct Cylinder {
    radius: f32,
    low: f32,
    high: f32,
}

impl Cylinder {
    /// Its surface, whose front is outside.
    fn mesh(&self) -> Mesh {
        let sides = 96;
        let mut mesh = Mesh::default();
        for i in 0..sides {
            let (sin, cos) = (TAU * i as f32 / sides as f32).sin_cos();
            for z in [self.low, self.high] {
                mesh.positions.push(vec3(self.radius * cos, self.radius * sin, z));
                mesh.normals.push(vec3(cos, sin, 0.0));
            }
            let [a, b] = [2 * i, 2 * ((i + 1) % sides)];
            mesh.triangles.extend([[a, b, b + 1], [a, b + 1, a + 1]]);
        }
        mesh
    }
}

/// The shapes of a scene, each with its role.
#[derive(Default)]
pub struct Shapes {
    pub ball: Option<(Ball, Role)>,
    pub bulb: Option<Bulb>,
    pub mesh: Mesh,
    /// The triangle that a part begins with, and its role.
    parts: Vec<(usize, Role)>,
}

impl Shapes {
    /// Adds a part.
    pub fn add(&mut self, mesh: Mesh, role: Role) {
        self.parts.push((self.mesh.triangles.len(), role));
        self.mesh.append(&mesh);
    }
}

/// Surfaces, materials and light.
pub struct Scene<'a> {
    ball: Option<(Ball, Shader<'a>)>,
    mesh: Mesh,
    tree: TriangleTree,
    /// The triangle that a part begins with, and its material.
    parts: Vec<(usize, Shader<'a>)>,
    object: Shader<'a>,
    /// The maps of a mesh that is the object, and their palette.
    skin: Option<(&'a Skin, Vec<Shader<'a>>)>,
    /// The light among the surfaces.
    pub bulb: Option<Bulb>,
    /// Cosine and sine of the turn of the samples about their normals.
    turn: Vec2,
    /// The light round them.
    pub environment: &'a Environment,
}

/// A point of a surface that a ray meets.
pub struct Surface<'s, 'a> {
    pub point: Vec3,
    /// Unit normal of the surface as it is, on either side.
    pub flat: Vec3,
    /// Unit normal of the smooth surface that the triangles stand for.
    pub smooth: Vec3,
    pub material: &'s Shader<'a>,
    /// A factor on all light that it reflects, linear sRGB.
    pub tint: Option<Vec3>,
    /// Cosine and sine of the turn of the sample about its normal.
    pub turn: Vec2,
}

impl<'a> Scene<'a> {
    /// Builds a scene of the object's material and that of all the rest.
    pub fn new(
        name: SceneName,
        object: impl Into<Shader<'a>>,
        rest: impl Into<Shader<'a>>,
        environment: &'a Environment,
    ) -> Self {
        let (object, rest) = (object.into(), rest.into());
        let material = |role| if role == Role::Object { object } else { rest };
        Self::build(name.shapes(None), material, environment)
    }

    /// Builds a scene of shapes, and a material for each role.
    pub fn build(
        shapes: Shapes,
        material: impl Fn(Role) -> Shader<'a>,
        environment: &'a Environment,
    ) -> Self {
        let Shapes { ball, bulb, mesh, parts } = shapes;
        Self {
            bulb,
            ball: ball.map(|(ball, role)| (ball, material(role))),
            tree: TriangleTree::new(&mesh),
            mesh,
            parts: parts.into_iter().map(|(first, role)| (first, material(role))).collect(),
            object: material(Role::Object),
            skin: None,
            turn: Vec2::X,
            environment,
        }
    }

    /// The same with maps on the mesh that is the object, which comes first among the shapes. The palette has all materials that they name.
    #[must_use]
    pub fn with_skin(self, skin: &'a Skin, palette: Vec<Shader<'a>>) -> Self {
        Self { skin: Some((skin, palette)), ..self }
    }

    /// The material and the tint of a place of the object, by its maps. `None` where it has none.
    ///
    /// One of two materials is chosen by a hash of the ray: it is another one for every path, and the same for every run.
    fn by_maps(&self, triangle: usize, point: Vec3, ray: &Ray) -> Option<(&Shader<'a>, Option<Vec3>)> {
        let (skin, palette) = self.skin.as_ref()?;
        let is_object = self.parts.get(1).is_none_or(|next| triangle < next.0);
        let place = self.mesh.coordinates_at(triangle, point).filter(|_| is_object)?;
        let bits = |v: Vec3| {
            let [x, y, z] = v.to_array().map(|v| u64::from(v.to_bits()));
            x ^ y << 32 ^ z.rotate_left(16)
        };
        let choice = Random::new(bits(ray.direction), bits(ray.origin), 0).unit();
        let (material, tint) = skin.at(place, choice);
        Some((palette.get(material)?, tint))
    }

    /// The same with samples that are turned about their normals, in degrees, counterclockwise as seen from outside.
    #[must_use]
    pub fn turned(self, degrees: f32) -> Self {
        Self { turn: Vec2::from_angle(degrees.to_radians()), ..self }
    }

    /// The nearest surface along a ray; `None` where a bulb is nearer than all.
    pub fn hit(&self, ray: &Ray) -> Option<Surface<'_, 'a>> {
        let at = |distance: f32| ray.origin + ray.direction * distance;
        let bulb = self.bulb.as_ref().and_then(|bulb| bulb.ball.hit(ray)).unwrap_or(f32::INFINITY);
        let ball = self.ball.as_ref().and_then(|(ball, shader)| Some((ball.hit(ray)?, ball, shader)));
        let ball = ball.filter(|found| found.0 < bulb);
        if let Some(hit) = self.tree.nearest(ray, ball.map_or(bulb, |found| found.0)) {
            let point = at(hit.distance);
            let (flat, smooth) = self.mesh.normals_at(hit.triangle, point);
            let part = self.parts.iter().rfind(|part| part.0 <= hit.triangle)?;
            let (material, tint) = self.by_maps(hit.triangle, point, ray).unwrap_or((&part.1, None));
            return Some(Surface { point, flat, smooth, material, tint, turn: self.turn });
        }
        ball.map(|(distance, ball, material)| {
            let normal = (at(distance) - ball.centre).normalize();
            let point = ball.centre + normal * ball.radius;
            Surface { point, flat: normal, smooth: normal, material, tint: None, turn: self.turn }
        })
    }

    /// Whether a ray meets nothing.
    pub fn is_clear(&self, ray: &Ray) -> bool {
        self.bulb_along(ray).is_none()
            && self.ball.as_ref().is_none_or(|(ball, _)| ball.hit(ray).is_none())
            && self.tree.is_clear(ray)
    }

    /// Whether a ray meets no surface nearer than that.
    pub fn is_clear_to(&self, ray: &Ray, distance: f32) -> bool {
        let ball = self.ball.as_ref().and_then(|(ball, _)| ball.hit(ray));
        ball.is_none_or(|ball| ball >= distance) && self.tree.nearest(ray, distance).is_none()
    }

    /// The bulb, if a ray that meets no surface before meets it.
    #[inline]
    pub fn bulb_along(&self, ray: &Ray) -> Option<&Bulb> {
        self.bulb.as_ref().filter(|bulb| bulb.ball.hit(ray).is_some())
    }

    /// The radiance along a ray that meets no surface: from the bulb, or from round the scene.
    pub fn light_along(&self, ray: &Ray) -> Vec3 {
        match self.bulb_along(ray) {
            Some(bulb) => bulb.radiance,
            None => self.environment.radiance(ray.direction),
        }
    }

    /// The materials of all parts.
    pub fn shaders(&self) -> impl Iterator<Item = &Shader<'a>> {
        let palette = self.skin.iter().flat_map(|skin| &skin.1);
        self.ball.iter().map(|ball| &ball.1).chain(self.parts.iter().map(|part| &part.1)).chain(palette)
    }

    /// The teapot on a floor of square tiles, each with a material of its own: the first is the teapot's too.
    pub fn mosaic(materials: &[Shader<'a>], environment: &'a Environment) -> Self {
        let mut mesh = teapot::tessellate(TEAPOT_STEPS);
        let mut parts = vec![(0, materials[0])];
        let side = materials.len().isqrt() + 1;
        let corner = |i: usize, j: usize| {
            let at = |n: usize| TILE * (n as f32 - 0.5 * side as f32);
            vec3(at(i), at(j), GROUND_HEIGHT)
        };
        for i in 0..side {
            for j in 0..side {
                let corners = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
                parts.push((mesh.triangles.len(), materials[(i * side + j) % materials.len()]));
                mesh.append(&Mesh::quadrilateral(corners));
            }
        }
        let tree = TriangleTree::new(&mesh);
        let (object, turn) = (materials[0], Vec2::X);
        Self { ball: None, bulb: None, tree, mesh, parts, object, skin: None, turn, environment }
    }

    /// The object's material.
    pub fn object(&self) -> &Shader<'a> {
        &self.object
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_of_a_scene_is_seen_with_its_own_material() {
        let light = Environment::constant(1.0).unwrap();
        let names = ["matte", "garnet_red", "krylon_blue", "cayman"];
        let stored = names.map(|name| crate::truth::stored::StoredMaterial::load(name).unwrap());
        let of = |role| match role {
            Role::Object => 1,
            Role::Ball => 2,
            Role::Left | Role::Right => 3,
            Role::Ground => 0,
        };
        let scene =
            Scene::build(SceneName::Room.shapes(None), |role| (&stored[of(role)].material).into(), &light);
        let size = [64, 64];
        let camera = SceneName::Room.camera(size);
        let mut seen = [0; 4];
        for i in 0..64 * 64 {
            let Some(surface) = scene.hit(&camera.ray((i % 64) as f32, (i / 64) as f32)) else { continue };
            let crate::truth::Truth::Lobes(material) = surface.material.truth else { panic!("no table") };
            seen[(0..4).find(|&n| std::ptr::eq(material, &stored[n].material)).unwrap()] += 1;
        }
        assert!(seen.iter().all(|&pixels| pixels > 100), "{seen:?}");
    }
}
