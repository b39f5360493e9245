//! Scratch.

fn main() {
    for dir in std::env::args().skip(1) {
        let d = std::path::Path::new(&dir);
        println!("== {dir}");
        let model = palpate::model::Model::read(&d.join("base.toml")).unwrap();
        let log = palpate::log::Log::read(&d.join("measured.csv"), &Default::default()).unwrap().uniform().unwrap();
        palpate::gap::try_it(&model, &[log]);
    }
}
