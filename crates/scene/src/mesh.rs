//! stub
use glam::DVec3;
/// x
#[derive(Debug)]
pub struct Mesh {
    v: Vec<DVec3>,
    t: Vec<[u32; 3]>,
}
#[allow(missing_docs)]
impl Mesh {
    pub fn vertices(&self) -> &[DVec3] {
        &self.v
    }
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.t
    }
    pub fn load(_: &std::path::Path) -> Result<Self, String> {
        Err("x".into())
    }
    pub fn star(r: f64, a: f64, l: u32, n: u32) -> Self {
        let mut v = vec![];
        let mut t = vec![];
        let m = 2 * n;
        for i in 0..=n {
            for j in 0..m {
                let th = std::f64::consts::PI * i as f64 / n as f64;
                let ph = std::f64::consts::TAU * j as f64 / m as f64;
                let rr = r * (1.0 + a * (l as f64 * ph).cos() * th.sin().powi(l as i32));
                v.push(DVec3::new(
                    rr * th.sin() * ph.cos(),
                    rr * th.sin() * ph.sin(),
                    rr * th.cos(),
                ));
            }
        }
        for i in 0..n {
            for j in 0..m {
                let k = (j + 1) % m;
                t.push([i * m + j, (i + 1) * m + j, (i + 1) * m + k]);
                t.push([i * m + j, (i + 1) * m + k, i * m + k]);
            }
        }
        Self { v, t }
    }
}
